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
      DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/grainfield FILES_MATCHING PATTERN "*.h"
      PATTERN detail EXCLUDE PATTERN "*-inl.h" EXCLUDE)
  endif()
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/generated/core/version.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/grainfield/core)

# Which package of grainfieldConfig.cmake gives a target that a room links.
set(package_of_CLI11::CLI11 CLI11)
set(package_of_Eigen3::Eigen Eigen3)
set(package_of_OpenCV::calib3d OpenCV)
set(package_of_OpenCV::core OpenCV)
set(package_of_OpenCV::imgproc OpenCV)
set(package_of_OpenMP::OpenMP_CXX OpenMP)
set(package_of_PNG::PNG PNG)
set(package_of_PkgConfig::FFTW FFTW)
set(package_of_PkgConfig::FFTWF FFTWF)
set(package_of_PkgConfig::HWY HWY)
set(package_of_PkgConfig::LIBAV LIBAV)
set(package_of_TIFF::TIFF TIFF)
set(package_of_Threads::Threads Threads)
set(package_of_ZLIB::ZLIB ZLIB)
set(package_of_embree embree)
set(package_of_fmt::fmt fmt)
set(package_of_nlohmann_json::nlohmann_json nlohmann_json)

set(GRAINFIELD_ROOM_NEEDS)
foreach(room IN LISTS GRAINFIELD_ROOMS)
  get_property(linked GLOBAL PROPERTY GRAINFIELD_NEEDS_${room})
  set(needs)
  foreach(item IN LISTS linked)
    if(item IN_LIST GRAINFIELD_ROOMS)
      list(APPEND needs ${item})
    elseif(TARGET ${item})  # a library by its path needs no package
      if(NOT DEFINED package_of_${item})
        message(FATAL_ERROR "cmake/InstallPackage.cmake does not say which package has '${item}' of '${room}'")
      endif()
      list(APPEND needs ${package_of_${item}})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES needs)
  list(JOIN needs " " needs)
  string(APPEND GRAINFIELD_ROOM_NEEDS "set(grainfield_needs_${room} ${needs})\n")
endforeach()

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/grainfieldConfig.cmake.in
  ${PROJECT_BINARY_DIR}/grainfieldConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/grainfield)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/grainfieldConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/grainfieldConfig.cmake
  ${PROJECT_BINARY_DIR}/grainfieldConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/cmake/FindOpenCV.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/grainfield)
