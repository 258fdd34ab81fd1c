#include "core/unit.h"

#include <charconv>
#include <optional>
#include <utility>

namespace grainfield {

namespace {

constexpr std::string_view time_symbol = "time unit";

// In the order in which a product names them.
constexpr std::array<std::string_view, 7> symbols{"m", "g", "a", "l", "px", time_symbol, "periods"};
constexpr std::string_view one_period = "period";

struct TimeText {
    const char* plain;
    const char* typeset;
};
constexpr std::array<TimeText, 3> time_texts{
    {{"frames", "frame"}, {"s", "s"}, {"sqrt(a/g)", "√(a/g)"}}};

using Powers = std::array<std::int8_t, 7>;

std::optional<std::size_t> base_of(std::string_view symbol) {
    if (symbol == one_period) return static_cast<std::size_t>(BaseUnit::period);
    for (std::size_t base = 0; base < symbols.size(); ++base) {
        if (symbols[base] == symbol) return base;
    }
    return std::nullopt;
}

// "a^2": adds `sign` times its power.
bool add_factor(std::string_view factor, int sign, Powers& powers) {
    int power = 1;
    if (const auto caret = factor.find('^'); caret != std::string_view::npos) {
        const std::string_view digits = factor.substr(caret + 1);
        const char* end = digits.data() + digits.size();
        const auto [stop, problem] = std::from_chars(digits.data(), end, power);
        if (problem != std::errc() || stop != end || power < 2 || power > 9) return false;
        factor = factor.substr(0, caret);
    }
    const auto base = base_of(factor);
    if (!base || powers[*base] != 0) return false;
    powers[*base] = static_cast<std::int8_t>(sign * power);
    return true;
}

// Factors with spaces between them; the symbol of time has a space of its own.
bool add_product(std::string_view product, int sign, Powers& powers) {
    while (!product.empty()) {
        const std::size_t from = product.starts_with(time_symbol) ? time_symbol.size() : 0;
        const std::size_t end = std::min(product.find(' ', from), product.size());
        if (!add_factor(product.substr(0, end), sign, powers)) return false;
        product.remove_prefix(std::min(end + 1, product.size()));
    }
    return true;
}

std::optional<Powers> parse(std::string_view text) {
    Powers powers{};
    const std::size_t slash = text.find('/');
    const std::string_view over = text.substr(0, slash);
    if (over != "1" && !add_product(over, 1, powers)) return std::nullopt;
    if (slash == std::string_view::npos) return powers;
    if (!add_product(text.substr(slash + 1), -1, powers)) return std::nullopt;
    return powers;
}

std::string product(const Powers& powers, int sign, std::string_view time) {
    std::string text;
    for (std::size_t base = 0; base < powers.size(); ++base) {
        const int power = sign * powers[base];
        if (power <= 0) continue;
        if (!text.empty()) text += ' ';
        if (base == static_cast<std::size_t>(BaseUnit::time)) {
            text += time;
        } else if (base == static_cast<std::size_t>(BaseUnit::period) && sign < 0) {
            text += one_period;
        } else {
            text += symbols[base];
        }
        if (power > 1) text += '^' + std::to_string(power);
    }
    return text;
}

// "a^2" → "a²"
std::string with_superscripts(std::string_view text) {
    static constexpr std::array<const char*, 10> raised{"⁰", "¹", "²", "³", "⁴",
                                                        "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const std::size_t end = text.find_first_not_of("-0123456789", i + 1);
        const std::size_t length = std::min(end, text.size()) - i - 1;
        if (text[i] != '^' || length == 0) {
            out += text[i];
            continue;
        }
        for (const char c : text.substr(i + 1, length)) {
            out += c == '-' ? "⁻" : raised[static_cast<std::size_t>(c - '0')];
        }
        i += length;
    }
    return out;
}

}  // namespace

std::string unit_text(const Unit& unit, std::string_view time) {
    if (!unit.other_.empty()) return unit.other_;
    const std::string over = product(unit.powers_, 1, time);
    const std::string under = product(unit.powers_, -1, time);
    if (under.empty()) return over.empty() ? "-" : over;
    return (over.empty() ? "1" : over) + "/" + under;
}

Unit::Unit(std::string_view text) {
    if (text.empty() || text == "-") return;
    if (const auto powers = parse(text)) powers_ = *powers;
    if (unit_text(*this, time_symbol) == text) return;
    powers_ = {};
    other_ = text;
}

Unit::Unit(const std::string& text) : Unit(std::string_view(text)) {}

std::string Unit::text() const {
    return unit_text(*this, time_symbol);
}

Unit Unit::on_lattice() const {
    Unit unit = *this;
    auto& length = unit.powers_[static_cast<std::size_t>(BaseUnit::diameter)];
    unit.powers_[static_cast<std::size_t>(BaseUnit::lattice)] += std::exchange(length, 0);
    return unit;
}

const char* plain_text(TimeUnit unit) {
    return time_texts[static_cast<std::size_t>(unit)].plain;
}

const char* typeset_text(TimeUnit unit) {
    return time_texts[static_cast<std::size_t>(unit)].typeset;
}

std::string plain_text(const Unit& unit, TimeUnit time_unit) {
    return unit_text(unit, plain_text(time_unit));
}

std::string typeset_text(const Unit& unit, TimeUnit time_unit) {
    if (unit.is_dimensionless()) return "";
    return with_superscripts(unit_text(unit, typeset_text(time_unit)));
}

std::string typeset_text(const Unit& unit) {
    return unit.is_dimensionless() ? "" : with_superscripts(unit.text());
}

}  // namespace grainfield
