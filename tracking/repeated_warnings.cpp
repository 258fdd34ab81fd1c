#include "tracking/repeated_warnings.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::tracking {
namespace {

constexpr const char* kKey = "repeated warnings";

/// Whether two texts differ in their numbers only.
bool is_alike(const std::string& a, const std::string& b) {
    const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-'; };
    std::size_t i = 0;
    std::size_t j = 0;
    while (i < a.size() && j < b.size()) {
        if (is_digit(a[i]) && is_digit(b[j])) {
            while (i < a.size() && is_digit(a[i])) ++i;
            while (j < b.size() && is_digit(b[j])) ++j;
        } else if (a[i++] != b[j++]) {
            return false;
        }
    }
    return i == a.size() && j == b.size();
}

}  // namespace

void RepeatedWarnings::add(std::int64_t frame, std::string text) {
    const auto known =
        std::ranges::find_if(kinds_, [&](const Kind& kind) { return is_alike(kind.text, text); });
    if (known == kinds_.end()) {
        kinds_.push_back({std::move(text), frame, frame, 1});
        return;
    }
    known->last = frame;
    ++known->count;
}

void RepeatedWarnings::say(const std::string& film, RunPlan& plan) const {
    for (const Kind& kind : kinds_) {
        plan.warn(kind.count == 1 ? fmt::format("{}, frame {}: {}", film, kind.first, kind.text)
                                  : fmt::format("{}, {} frames from {} to {}: {}", film, kind.count,
                                                kind.first, kind.last, kind.text));
    }
}

void RepeatedWarnings::save(Checkpoint& checkpoint) const {
    for (const Kind& kind : kinds_) {
        checkpoint.texts[kKey].push_back(kind.text);
        for (const std::int64_t number : {kind.first, kind.last, kind.count}) {
            checkpoint.integers[kKey].push_back(number);
        }
    }
}

void RepeatedWarnings::restore(const Checkpoint& checkpoint) {
    kinds_.clear();
    const auto texts = checkpoint.texts.find(kKey);
    if (texts == checkpoint.texts.end()) return;
    const auto numbers = checkpoint.integers.find(kKey);
    if (numbers == checkpoint.integers.end() ||
        numbers->second.size() != 3 * texts->second.size()) {
        throw InputError({.problem = "the checkpoint is damaged",
                          .actual = fmt::format("its list '{}' is not whole", kKey),
                          .expected = "three numbers a warning",
                          .suggestion = "start again from the beginning"});
    }
    for (std::size_t i = 0; i < texts->second.size(); ++i) {
        const auto number = [&](std::size_t k) { return numbers->second[3 * i + k]; };
        kinds_.push_back({texts->second[i], number(0), number(1), number(2)});
    }
}

}  // namespace grainfield::tracking
