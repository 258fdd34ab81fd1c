#include "io/frame_range.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "io/images/picture.h"
#include "io/passed_frames.h"

namespace grainfield::io {

namespace {

[[noreturn]] void refuse(std::string_view range, std::string actual, std::string expected) {
    throw OptionError({.problem = fmt::format("frame range '{}' cannot be used", range),
                       .actual = std::move(actual),
                       .expected = std::move(expected),
                       .suggestion = "for example 100:200, ::10 or -50:"});
}

std::string_view trimmed(std::string_view text) {
    while (text.starts_with(' ')) text.remove_prefix(1);
    while (text.ends_with(' ')) text.remove_suffix(1);
    return text;
}

std::optional<std::int64_t> parse(std::string_view range, std::string_view part) {
    part = trimmed(part);
    if (part.empty()) return std::nullopt;
    if (part.starts_with('+')) part.remove_prefix(1);
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size()) {
        refuse(range, fmt::format("'{}'", part), "FIRST:END:STEP in whole numbers");
    }
    return value;
}

std::int64_t from_start(std::int64_t value, std::int64_t count) {
    // Compared before adding, so that no number of the user can overflow.
    if (value < -count) return 0;
    return std::min(value < 0 ? value + count : value, count);
}

FrameSelection single(std::string_view range, std::int64_t index, std::int64_t count) {
    if (index < -count || index >= count) {
        refuse(range, fmt::format("frame {}", index), fmt::format("0 … {}", count - 1));
    }
    return {.first = index < 0 ? index + count : index, .step = 1, .count = 1};
}

// A range as it is written, for a source of any number of frames.
struct WrittenRange {
    std::optional<std::int64_t> first, end;
    std::int64_t step = 1;
    bool is_single = false;  // frame `first` alone
};

WrittenRange parse_range(std::string_view range) {
    std::array<std::optional<std::int64_t>, 3> numbers;
    std::size_t parts = 0;
    for (std::string_view rest = range;; ++parts) {
        if (parts == numbers.size()) refuse(range, "more than two colons", "FIRST:END:STEP");
        const std::size_t colon = rest.find(':');
        numbers[parts] = parse(range, rest.substr(0, colon));
        if (colon == std::string_view::npos) break;
        rest.remove_prefix(colon + 1);
    }
    const WrittenRange written{numbers[0], numbers[1], numbers[2].value_or(1),
                               parts == 0 && numbers[0].has_value()};
    if (written.step <= 0) {
        refuse(range, fmt::format("step {}", written.step), "a step of at least 1");
    }
    return written;
}

FrameSelection selection_of(std::string_view range, std::int64_t count) {
    const WrittenRange written = parse_range(range);
    if (written.is_single) return single(range, *written.first, count);
    const std::int64_t step = written.step;
    const std::int64_t first = from_start(written.first.value_or(0), count);
    const std::int64_t end = from_start(written.end.value_or(count), count);
    if (first >= end) {
        refuse(range, "it selects no frame", fmt::format("a range within 0:{}", count));
    }
    return {.first = first, .step = step, .count = (end - first - 1) / step + 1};
}

class SelectedFrames : public PassedFrames {
 public:
    SelectedFrames(std::unique_ptr<FrameSource> source, FrameSelection selection)
        : PassedFrames(std::move(source)), selection_(selection) {}

    std::int64_t count() const override { return selection_.count; }

    Frame read(std::int64_t position) override {
        require_frame_index(position, selection_.count, name() + " (selected frames)");
        return source().read(selection_.first + position * selection_.step);
    }

 private:
    FrameSelection selection_;
};

}  // namespace

std::unique_ptr<FrameSource> select_frames(std::unique_ptr<FrameSource> source,
                                           std::string_view range) {
    const FrameSelection selection = frame_selection(range, source->count());
    if (selection.count == source->count()) return source;
    return std::make_unique<SelectedFrames>(std::move(source), selection);
}

FrameSelection frame_selection(std::string_view range, std::int64_t count) {
    return selection_of(trimmed(range), count);
}

bool selects_all(std::string_view range) {
    return trimmed(range).empty() || trimmed(range) == kAllFrames;
}

std::string in_words(std::string_view range) {
    if (selects_all(range)) return "all frames";
    const WrittenRange written = parse_range(trimmed(range));
    if (written.is_single) return fmt::format("frame {}", *written.first);
    const std::string steps =
        written.step > 1 ? fmt::format(" in steps of {}", written.step) : std::string();
    const auto is_counted_back = [](const auto& number) { return number && *number < 0; };
    if (is_counted_back(written.first) && !written.end) {
        if (*written.first == -1) return "last frame";
        const auto back = std::uint64_t{0} - static_cast<std::uint64_t>(*written.first);
        return fmt::format("last {} frames{}", back, steps);
    }
    if (is_counted_back(written.first) || is_counted_back(written.end)) {
        return fmt::format("frames {}", trimmed(range));
    }
    if (!written.end) {
        return written.first ? fmt::format("frames from {}{}", *written.first, steps)
                             : fmt::format("frames{}", steps);
    }
    const std::int64_t first = written.first.value_or(0);
    if (*written.end == first + 1) return fmt::format("frame {}", first);
    return fmt::format("frames {} to {}{}", first, *written.end - 1, steps);
}

FrameSelection selection_or_none(std::string_view range, std::int64_t count) {
    if (count == 0 && selects_all(range)) return {};
    return frame_selection(range, count);
}

FilmPart part_of_film(std::string_view range, std::string_view film, std::int64_t count) {
    const FrameSelection part = frame_selection(range, count);
    FilmPart found;
    found.film =
        trimmed(film).empty()
            ? frame_selection(fmt::format("{}::{}", part.first % part.step, part.step), count)
            : frame_selection(film, count);
    const std::int64_t step = found.film.step;
    const std::int64_t ahead = part.first - found.film.first;
    found.span = {ahead / step, ahead / step + part.count};
    if (ahead < 0 || ahead % step != 0 || (part.count > 1 && part.step != step) ||
        found.span.end > found.film.count) {
        throw OptionError(
            {.problem = fmt::format("frames '{}' are no part of the film '{}'", range, film),
             .actual = fmt::format("frames {} to {} in steps of {}", part.first,
                                   part.first + (part.count - 1) * part.step, part.step),
             .expected = fmt::format("some of frames {} to {} in steps of {}", found.film.first,
                                     found.film.first + (found.film.count - 1) * step, step),
             .suggestion = "the step of both must be the same"});
    }
    return found;
}

}  // namespace grainfield::io
