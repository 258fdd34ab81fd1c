# `cmake --install`, and find_package(grainfield) for programs that use the libraries.
include(CMakePackageConfigHelpers)

get_property(grainfield_libraries GLOBAL PROPERTY GRAINFIELD_LIBRARIES)
install(TARGETS ${grainfield_libraries} EXPORT grainfield
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT grainfield NAMESPACE grainfield:: FILE grainfieldTargets.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/grainfield)

foreach(room IN LISTS GRAINFIELD_ROOMS)
  if(EXISTS ${PROJECT_SOURCE_DIR}/${room})
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/${room}
      DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/grainfield FILES_MATCHING PATTERN "*.h")
  endif()
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/generated/core/version.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/grainfield/core)

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/grainfieldConfig.cmake.in
  ${PROJECT_BINARY_DIR}/grainfieldConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/grainfield)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/grainfieldConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/grainfieldConfig.cmake
  ${PROJECT_BINARY_DIR}/grainfieldConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/cmake/FindOpenCV.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/grainfield)
