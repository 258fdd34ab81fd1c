#pragma once

#include <cstddef>
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
/// for.
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
                value = static_cast<T>(take());
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
                          .suggestion = "start the run anew"});
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
