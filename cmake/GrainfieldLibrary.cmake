# grainfield_library(NAME SOURCES … [PUBLIC libs…] [PRIVATE libs…] [INTERNAL core …])
#
# One library per top-level folder, alias grainfield::NAME. The arrows
#     core <- {io, tracking, simulate, analysis, report} <- pipelines <- {app, python}
# are enforced twice: INTERNAL may name only `core` (pipelines: their rooms; app: anything), and each library exposes only
# its own folder on the include path, so that a header of a sibling is not found by the compiler.
set(GRAINFIELD_ROOMS core io tracking simulate analysis report pipelines app)

function(grainfield_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE;INTERNAL" ${ARGN})
  if(NOT name IN_LIST GRAINFIELD_ROOMS)
    message(FATAL_ERROR "grainfield_library: '${name}' is not a room of the house (${GRAINFIELD_ROOMS})")
  endif()
  foreach(dependency IN LISTS ARG_INTERNAL)
    list(FIND GRAINFIELD_ROOMS ${name} place)
    list(FIND GRAINFIELD_ROOMS ${dependency} place_of_dependency)
    if(name STREQUAL "core" OR place_of_dependency LESS 0 OR NOT place_of_dependency LESS place
       OR (NOT dependency STREQUAL "core" AND NOT name MATCHES "^(pipelines|app)$"))
      message(FATAL_ERROR
        "grainfield_library: '${name}' may not depend on '${dependency}': siblings meet in core types")
    endif()
  endforeach()

  foreach(dependency IN LISTS ARG_PUBLIC ARG_PRIVATE)
    if(dependency MATCHES "^grainfield(::|_)")
      message(FATAL_ERROR "grainfield_library: '${name}' must name '${dependency}' under INTERNAL")
    endif()
  endforeach()

  set(include_root ${PROJECT_BINARY_DIR}/include/${name})
  file(MAKE_DIRECTORY ${include_root})
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${name} ${include_root}/${name} SYMBOLIC)

  set(target grainfield_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(grainfield::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${include_root}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/grainfield>)
  list(TRANSFORM ARG_INTERNAL PREPEND grainfield_ OUTPUT_VARIABLE internal)
  target_link_libraries(${target}
    PUBLIC ${internal} ${ARG_PUBLIC}
    PRIVATE $<BUILD_INTERFACE:grainfield_compile_options> ${ARG_PRIVATE})
  target_compile_features(${target} PUBLIC cxx_std_20)
  if(GRAINFIELD_PRECOMPILE)
    target_precompile_headers(${target} PRIVATE ${GRAINFIELD_PRECOMPILED})
  endif()
  set_property(GLOBAL APPEND PROPERTY GRAINFIELD_LIBRARIES ${target})
  # What find_package(grainfield COMPONENTS name) has to find.
  set_property(GLOBAL PROPERTY GRAINFIELD_NEEDS_${name} ${ARG_INTERNAL} ${ARG_PUBLIC} ${ARG_PRIVATE})
endfunction()

# grainfield_test(x_test.cpp [LIBS rooms…] [PRIVATE libs…])
# CTest name = path from tests/ without "_test.cpp".
function(grainfield_test source)
  cmake_parse_arguments(ARG "" "" "LIBS;PRIVATE" ${ARGN})
  file(RELATIVE_PATH name ${PROJECT_SOURCE_DIR}/tests ${CMAKE_CURRENT_SOURCE_DIR}/${source})
  string(REGEX REPLACE "_test\\.cpp$" "" name ${name})
  string(REPLACE "/" "." target ${name})
  list(TRANSFORM ARG_LIBS PREPEND grainfield::)
  add_executable(test.${target} ${source})
  target_include_directories(test.${target} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(test.${target} PRIVATE
    grainfield_compile_options ${ARG_LIBS} ${ARG_PRIVATE} GTest::gtest_main GTest::gmock)
  target_compile_definitions(test.${target} PRIVATE
    GRAINFIELD_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    GRAINFIELD_PROGRAM="${PROJECT_BINARY_DIR}/grainfield")
  if(GRAINFIELD_PRECOMPILE)
    target_precompile_headers(test.${target} REUSE_FROM precompiled_tests)
  endif()
  add_test(NAME ${name} COMMAND test.${target})
endfunction()
