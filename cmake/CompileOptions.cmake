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
if(GRAINFIELD_SANITIZE)
  target_compile_options(grainfield_compile_options INTERFACE
    -fsanitize=${GRAINFIELD_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(grainfield_compile_options INTERFACE -fsanitize=${GRAINFIELD_SANITIZE})
endif()
if(GRAINFIELD_COVERAGE)
  target_compile_options(grainfield_compile_options INTERFACE --coverage)
  target_link_options(grainfield_compile_options INTERFACE --coverage)
endif()

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_CXX_FLAGS_RELEASE "-O3")
