// The entry point that clang's libFuzzer calls; GRAINFIELD_FUZZED is a function of readers.h.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "tests/fuzz/readers.h"

// The sanitizer does not know the exceptions of the standard library.
__attribute__((no_sanitize("vptr"))) extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                                                           std::size_t size) {
    try {
        grainfield::fuzz::GRAINFIELD_FUZZED({reinterpret_cast<const char*>(data), size});
    } catch (const std::exception& fault) {
        std::fprintf(stderr, "fuzz: %s\n", fault.what());
        std::abort();
    }
    return 0;
}
