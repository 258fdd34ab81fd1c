#include "core/errors.h"

namespace grainfield {

std::string ErrorText::message() const {
    std::string text = problem;
    if (!actual.empty()) text += ": " + actual;
    if (!expected.empty()) text += "; expected " + expected;
    if (!suggestion.empty()) text += "; " + suggestion;
    if (!text.empty() && text.back() != '.' && text.back() != '?') text += '.';
    return text;
}

}  // namespace grainfield
