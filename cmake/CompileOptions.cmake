# Small interface targets that every grainfield target links: warnings, sanitizers, optimisation.
add_library(grainfield_compile_options INTERFACE)
target_compile_features(grainfield_compile_options INTERFACE cxx_std_20)
target_compile_options(grainfield_compile_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wnon-virtual-dtor
  -Woverloaded-virtual -Wdouble-promotion
  # The same source gives the same bits on every x86-64: no silent fused multiply-add.
  -ffp-contract=off
  # Lets loops over sqrt and comparisons vectorise; values are unchanged.
  -fno-math-errno -fno-trapping-math)
if(GRAINFIELD_WERROR)
  target_compile_options(grainfield_compile_options INTERFACE -Werror)
endif()
set(sanitizers ${GRAINFIELD_SANITIZE})
if(GRAINFIELD_FUZZERS)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "GRAINFIELD_FUZZERS needs clang: cmake --preset fuzz, or scripts/fuzz")
  endif()
  list(APPEND sanitizers fuzzer-no-link)
endif()
if(sanitizers)
  list(JOIN sanitizers "," sanitizers)
  target_compile_options(grainfield_compile_options INTERFACE -fsanitize=${sanitizers} -fno-omit-frame-pointer)
  target_link_options(grainfield_compile_options INTERFACE -fsanitize=${sanitizers})
endif()
if(GRAINFIELD_COVERAGE)
  target_compile_options(grainfield_compile_options INTERFACE --coverage)
  target_link_options(grainfield_compile_options INTERFACE --coverage)
endif()

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_CXX_FLAGS_RELEASE "-O3")

# For slow compilers: what most sources include is compiled once for each library, and once for all tests. The programs
# are the same. It is off by default, as it hides an include that a source forgot.
option(GRAINFIELD_PRECOMPILE "Compile common headers once" OFF)
set(GRAINFIELD_PRECOMPILED <algorithm> <array> <chrono> <cmath> <complex> <filesystem> <fstream> <functional> <limits>
  <map> <memory> <mutex> <numeric> <optional> <random> <set> <span> <string> <unordered_map> <variant> <vector>
  <fmt/format.h>)
