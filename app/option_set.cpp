#include "app/option_set.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <map>
#include <set>

namespace grainfield::app {

OptionSet::OptionSet(std::string command, const std::vector<OptionTable>& tables)
    : command_(std::move(command)), own_section_(command_.substr(command_.rfind(' ') + 1)) {
    std::map<std::string, int> uses;
    for (const OptionTable& table : tables) {
        for (const Option& row : table.rows()) ++uses[row.name];
    }
    // "cell-height" of one section may be what "height" of the section [cell] is called.
    std::set<std::string> taken;
    for (const OptionTable& table : tables) {
        for (const Option& row : table.rows()) {
            if (uses[row.name] > 1) taken.insert(table.section() + "-" + row.name);
        }
    }
    for (const OptionTable& table : tables) {
        for (const Option& row : table.rows()) {
            const bool shared =
                (uses[row.name] > 1 || taken.contains(row.name)) && !table.section().empty();
            entries_.push_back({.section = table.section(),
                                .flag = shared ? table.section() + "-" + row.name : row.name,
                                .option = row});
        }
    }
    drop_taken_names();
}

// Another name that an option of another section has for its own.
void OptionSet::drop_taken_names() {
    std::set<std::string> flags;
    for (const Entry& entry : entries_) flags.insert(entry.flag);
    for (Entry& entry : entries_) {
        std::erase_if(entry.option.other_names,
                      [&](const std::string& other) { return !flags.insert(other).second; });
    }
}

std::string OptionSet::with_flags(std::string text) const {
    const auto is_letter = [&](std::size_t at) {
        return at < text.size() && std::isalnum(static_cast<unsigned char>(text[at])) != 0;
    };
    const auto is_one_of = [&](std::size_t at, std::string_view characters) {
        return at < text.size() && characters.find(text[at]) != std::string_view::npos;
    };
    // "model.b" of "model.b.h5" or "runs/model.b" is part of the name of a file.
    const auto is_whole_word = [&](std::size_t begin, std::size_t end) {
        if (begin > 0 && (is_letter(begin - 1) || is_one_of(begin - 1, "-_./"))) return false;
        if (is_letter(end) || is_one_of(end, "-_/")) return false;
        return !(is_one_of(end, ".") && is_letter(end + 1));
    };
    for (const Entry& entry : entries_) {
        // A plain word is a name only between these quotation marks.
        const std::string name = entry.section.empty() ? "option '" + entry.option.name + "'"
                                                       : entry.section + "." + entry.option.name;
        const std::string flag = "--" + entry.flag;
        std::size_t at = text.find(name);
        while (at != std::string::npos) {
            const bool is_whole = is_whole_word(at, at + name.size());
            if (is_whole) text.replace(at, name.size(), flag);
            at = text.find(name, at + (is_whole ? flag.size() : 1));
        }
    }
    return text;
}

std::vector<std::string> OptionSet::flags() const {
    std::vector<std::string> names;
    for (const Entry& entry : entries_) {
        names.push_back(entry.flag);
        std::ranges::copy(entry.option.other_names, std::back_inserter(names));
    }
    return names;
}

bool OptionSet::has_section(std::string_view section) const {
    return std::ranges::any_of(entries_,
                               [&](const Entry& entry) { return belongs(entry, section); });
}

std::vector<std::string> OptionSet::sections() const {
    std::vector<std::string> names{own_section_};
    for (const Entry& entry : entries_) {
        if (!entry.section.empty() && std::ranges::find(names, entry.section) == names.end()) {
            names.push_back(entry.section);
        }
    }
    return names;
}

std::vector<std::string> OptionSet::keys(std::string_view section) const {
    std::vector<std::string> names;
    for (const Entry& entry : entries_) {
        if (!belongs(entry, section)) continue;
        names.push_back(entry.option.name);
        std::ranges::copy(entry.option.other_names, std::back_inserter(names));
    }
    return names;
}

const OptionSet::Entry* OptionSet::find(std::string_view section, std::string_view key) const {
    const auto found = std::ranges::find_if(entries_, [&](const Entry& entry) {
        return belongs(entry, section) && entry.option.is_called(key);
    });
    return found == entries_.end() ? nullptr : &*found;
}

bool OptionSet::belongs(const Entry& entry, std::string_view section) const {
    return entry.section == section || (entry.section.empty() && section == own_section_);
}

std::vector<std::pair<std::string, std::string>> OptionSet::configuration() const {
    std::vector<std::pair<std::string, std::string>> pairs;
    for (const Entry& entry : entries_) {
        if (entry.option.effect == Effect::call) continue;
        pairs.emplace_back(recorded_name(entry), to_text(entry.option.get()));
    }
    return pairs;
}

std::vector<std::string> OptionSet::indifferent() const {
    std::vector<std::string> names;
    for (const Entry& entry : entries_) {
        if (entry.option.effect == Effect::work) names.push_back(recorded_name(entry));
    }
    return names;
}

std::string OptionSet::recorded_name(const Entry& entry) {
    return (entry.section.empty() ? "" : entry.section + ".") + entry.option.name;
}

}  // namespace grainfield::app
