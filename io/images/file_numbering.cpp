#include "io/images/file_numbering.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::io {

namespace {

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// The name cut into runs of digits and of other characters: "run2_007.tif" → run|2|_|007|.tif
std::vector<std::string_view> split_runs(std::string_view name) {
    std::vector<std::string_view> runs;
    for (std::size_t start = 0; start < name.size();) {
        std::size_t end = start + 1;
        while (end < name.size() && is_digit(name[end]) == is_digit(name[start])) ++end;
        runs.push_back(name.substr(start, end - start));
        start = end;
    }
    return runs;
}

std::string_view without_zeros(std::string_view digits) {
    while (digits.size() > 1 && digits.front() == '0') digits.remove_prefix(1);
    return digits;
}

/// The one running number of a list of names.
struct Numbering {
    std::size_t run = 0;  ///< which run of the name it is
    std::vector<std::int64_t> numbers;
};

std::optional<std::int64_t> to_number(std::string_view digits) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
    return value;
}

/// Empty unless all names are alike but for one run of digits, with increasing numbers.
std::optional<Numbering> find_numbering(const std::vector<std::string>& names) {
    const auto first = split_runs(names.front());
    std::optional<std::size_t> running;
    for (const std::string& name : names) {
        const auto runs = split_runs(name);
        if (runs.size() != first.size()) return std::nullopt;
        for (std::size_t i = 0; i < runs.size(); ++i) {
            if (runs[i] == first[i]) continue;
            if (!is_digit(runs[i].front()) || !is_digit(first[i].front())) return std::nullopt;
            if (running && *running != i) return std::nullopt;
            running = i;
        }
    }
    if (!running) return std::nullopt;
    Numbering numbering{*running, {}};
    for (const std::string& name : names) {
        const auto number = to_number(split_runs(name)[*running]);
        if (!number) return std::nullopt;
        if (!numbering.numbers.empty() && *number <= numbering.numbers.back()) return std::nullopt;
        numbering.numbers.push_back(*number);
    }
    return numbering;
}

std::filesystem::path name_for(const std::filesystem::path& like, std::size_t run,
                               std::int64_t number) {
    const std::string name = like.filename().string();
    const auto runs = split_runs(name);
    std::string made;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        made += i == run ? fmt::format("{:0{}}", number, runs[i].size()) : std::string(runs[i]);
    }
    return like.parent_path() / made;
}

void refuse_duplicates(const std::vector<std::filesystem::path>& sorted) {
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice == sorted.end()) return;
    throw InputError({.problem = fmt::format("'{}' is given twice", twice->string()),
                      .actual = {},
                      .expected = "every image once",
                      .suggestion = "check the list of files"});
}

NumberedFiles open_gaps(std::vector<std::filesystem::path> sorted, const Numbering& numbering) {
    const auto& numbers = numbering.numbers;
    std::int64_t step = 0;
    for (std::size_t i = 1; i < numbers.size(); ++i) {
        step = std::gcd(step, numbers[i] - numbers[i - 1]);
    }
    const auto present = static_cast<std::int64_t>(sorted.size());
    const std::int64_t spanned = (numbers.back() - numbers.front()) / step + 1;
    if (spanned - present > present) {
        return {.files = std::move(sorted),
                .missing_names = {},
                .warnings = {fmt::format("the numbers of the images leave more gaps ({}) than "
                                         "there are images ({}); taken as consecutive",
                                         spanned - present, present)},
                .step = step};
    }
    NumberedFiles result{.files = {}, .missing_names = {}, .warnings = {}, .step = step};
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        for (std::int64_t n = i == 0 ? numbers[0] : numbers[i - 1] + step; n < numbers[i];
             n += step) {
            result.files.emplace_back();
            result.missing_names.push_back(name_for(sorted[i - 1], numbering.run, n));
        }
        result.files.push_back(sorted[i]);
    }
    return result;
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
    const auto left = split_runs(a);
    const auto right = split_runs(b);
    for (std::size_t i = 0; i < std::min(left.size(), right.size()); ++i) {
        if (is_digit(left[i].front()) && is_digit(right[i].front())) {
            const auto x = without_zeros(left[i]);
            const auto y = without_zeros(right[i]);
            if (x.size() != y.size()) return x.size() < y.size();
            if (x != y) return x < y;
        } else if (left[i] != right[i]) {
            return left[i] < right[i];
        }
    }
    if (left.size() != right.size()) return left.size() < right.size();
    return a < b;  // "f01" and "f1" are of equal rank, but the order must be total
}

NumberedFiles number_files(std::vector<std::filesystem::path> files) {
    std::vector<std::filesystem::path> sorted = files;
    std::sort(sorted.begin(), sorted.end(),
              [](const auto& a, const auto& b) { return natural_less(a.native(), b.native()); });
    refuse_duplicates(sorted);
    if (sorted.size() > 1) {
        std::vector<std::string> names;
        for (const auto& file : sorted) names.push_back(file.filename().string());
        if (const auto numbering = find_numbering(names)) {
            return open_gaps(std::move(sorted), *numbering);
        }
    }
    NumberedFiles result;
    if (sorted != files) {
        result.warnings.push_back("the images were put in order of their names, not as given");
    }
    result.files = std::move(sorted);
    return result;
}

}  // namespace grainfield::io
