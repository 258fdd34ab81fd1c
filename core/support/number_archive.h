#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/errors.h"
#include "core/vec2.h"
#include "core/vec3.h"

namespace grainfield {

/// Collects numbers, or gives them back in the same order: one function
///
///     void transfer(NumberArchive& archive, T& value) { archive(value.a); archive(value.b); }
///
/// both saves a T and restores it, so that the two cannot differ. Every bit of a double is kept;
/// integers must be below 2^53. Throws InputError when there are not as many numbers as are asked
/// for, or one is not of the type that is asked for.
class NumberArchive {
 public:
    /// To save.
    NumberArchive() = default;
    /// To restore; the numbers must outlive the archive.
    explicit NumberArchive(std::span<const double> numbers) : rest_(numbers), restores_(true) {}

    bool restores() const { return restores_; }
    std::vector<double> take_numbers() { return std::move(saved_); }
    /// Call after the last value was restored.
    void require_end() const {
        if (!rest_.empty()) fail("more numbers than expected");
    }

    template <class T>
    void operator()(T& value) {
        if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
            if (restores_) {
                value = exactly<T>(take());
            } else {
                saved_.push_back(static_cast<double>(value));
            }
        } else {
            transfer(*this, value);
        }
    }

    void operator()(Vec2& v) {
        (*this)(v.x);
        (*this)(v.y);
    }
    void operator()(Vec3& v) {
        (*this)(v.x);
        (*this)(v.y);
        (*this)(v.z);
    }

    template <class T>
    void operator()(std::optional<T>& value) {
        bool is_there = value.has_value();
        (*this)(is_there);
        if (restores_) value = is_there ? std::optional<T>(T{}) : std::nullopt;
        if (value) (*this)(*value);
    }

    /// All members of a struct, in the order of their declaration:
    ///
    ///     void transfer(NumberArchive& archive, T& value) {
    ///         auto& [a, b] = value;        // does not compile unless every member has a name
    ///         archive.members<T>(a, b);    // nor this, unless what is listed fills a T
    ///     }
    template <class T, class... Members>
    void members(Members&... list) {
        static_assert(filled<T, Members...>() == sizeof(T), "not every member is listed");
        ((*this)(list), ...);
    }

    /// Of a vector or deque.
    template <class List>
    void list(List& values) {
        std::size_t count = values.size();
        (*this)(count);
        if (restores_) {
            // An entry is one number at least.
            if (count > rest_.size()) fail("fewer numbers than expected");
            values.clear();
            values.resize(count);
        }
        for (auto& value : values) (*this)(value);
    }
    template <class T>
    void operator()(std::vector<T>& values) {
        list(values);
    }

 private:
    [[noreturn]] static void fail(const char* actual) {
        throw InputError({.problem = "stored numbers do not fit",
                          .actual = actual,
                          .expected = {},
                          .suggestion = "start again from the beginning"});
    }
    /// The size of a struct with these members.
    template <class T, class... Members>
    static constexpr std::size_t filled() {
        std::size_t end = 0;
        const auto place = [&](std::size_t size, std::size_t alignment) {
            end = (end + alignment - 1) / alignment * alignment + size;
        };
        (place(sizeof(Members), alignof(Members)), ...);
        place(0, alignof(T));
        return end;
    }
    /// The number as a T; refused where a T cannot have been it.
    template <class T>
    static T exactly(double number) {
        if constexpr (std::is_enum_v<T>) {
            return static_cast<T>(exactly<std::underlying_type_t<T>>(number));
        } else if constexpr (std::is_same_v<T, bool>) {
            if (number != 0 && number != 1) fail("a number that is neither 0 nor 1");
            return number != 0;
        } else if constexpr (std::is_integral_v<T>) {
            constexpr double most = 9007199254740992;  // 2^53
            constexpr double lowest = static_cast<double>(std::numeric_limits<T>::lowest());
            constexpr double highest = static_cast<double>(std::numeric_limits<T>::max());
            if (!(number >= std::max(lowest, -most) && number <= std::min(highest, most)) ||
                number != std::trunc(number)) {
                fail("a number that is not whole or too large");
            }
            return static_cast<T>(number);
        } else {
            constexpr double highest = static_cast<double>(std::numeric_limits<T>::max());
            if (std::isfinite(number) && std::abs(number) > highest) {
                fail("a number that is too large");
            }
            return static_cast<T>(number);
        }
    }
    double take() {
        if (rest_.empty()) fail("fewer numbers than expected");
        const double number = rest_.front();
        rest_ = rest_.subspan(1);
        return number;
    }

    std::vector<double> saved_;
    std::span<const double> rest_;
    bool restores_ = false;
};

}  // namespace grainfield
