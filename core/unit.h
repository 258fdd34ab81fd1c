#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace grainfield {

enum class LengthUnit : std::uint8_t { pixel, diameter };  ///< video: pixel; simulation: a
/// `frame` when no frame rate is known.
enum class TimeUnit : std::uint8_t { frame, second, sqrt_a_over_g };

/// What units are products of.
enum class BaseUnit : std::uint8_t {
    grain_mass,  ///< m
    gravity,     ///< g
    diameter,    ///< a
    lattice,     ///< l, the length unit of the field model
    pixel,
    time,   ///< of the trajectory, which knows its TimeUnit
    period  ///< of the vibration
};

/// The unit of a number: a product of powers of base units such as a²/time unit. Texts of units
/// are read and written here and nowhere else; a text that is no such product is kept as it stands.
class Unit {
 public:
    Unit() = default;  ///< dimensionless
    // Implicit, so that tables of results can be written with the texts of their units.
    Unit(std::string_view text);                              // NOLINT(google-explicit-constructor)
    Unit(const std::string& text);                            // NOLINT(google-explicit-constructor)
    Unit(const char* text) : Unit(std::string_view(text)) {}  // NOLINT(google-explicit-constructor)

    /// "a^2/time unit", "-" if dimensionless: as files hold it.
    std::string text() const;
    bool is_dimensionless() const { return *this == Unit(); }
    int power(BaseUnit base) const { return powers_[static_cast<std::size_t>(base)]; }
    /// The same with lengths in l instead of a.
    Unit on_lattice() const;

    friend bool operator==(const Unit&, const Unit&) = default;

 private:
    friend std::string unit_text(const Unit& unit, std::string_view time);

    std::array<std::int8_t, 7> powers_{};
    std::string other_;  ///< a text that is no product of powers
};

/// "frames", "s", "sqrt(a/g)"
const char* plain_text(TimeUnit unit);
/// "frame", "s", "√(a/g)"
const char* typeset_text(TimeUnit unit);

/// "a^2/s": the time unit by its name.
std::string plain_text(const Unit& unit, TimeUnit time_unit);
/// "a²/s" for people; empty if dimensionless.
std::string typeset_text(const Unit& unit, TimeUnit time_unit);
/// The same where the time unit is not known: "a²/time unit".
std::string typeset_text(const Unit& unit);

}  // namespace grainfield
