# find_package(OpenCV [version] [REQUIRED] [COMPONENTS core imgproc …]): targets OpenCV::core, OpenCV::imgproc, …
#
# Debian's libopencv-core-dev and libopencv-imgproc-dev carry neither OpenCVConfig.cmake nor opencv4.pc; those come
# only with libopencv-dev, which pulls in every module and its dependencies. Sets OpenCV_VERSION and
# OpenCV_INCLUDE_DIRS.
find_path(OpenCV_INCLUDE_DIR opencv2/core/mat.hpp PATH_SUFFIXES opencv4)
# Debian keeps the header that lists the modules in the folder of the architecture.
find_path(OpenCV_MODULES_INCLUDE_DIR opencv2/opencv_modules.hpp
  PATH_SUFFIXES opencv4 ${CMAKE_LIBRARY_ARCHITECTURE}/opencv4)
mark_as_advanced(OpenCV_INCLUDE_DIR OpenCV_MODULES_INCLUDE_DIR)
set(OpenCV_INCLUDE_DIRS ${OpenCV_INCLUDE_DIR} ${OpenCV_MODULES_INCLUDE_DIR})
list(REMOVE_DUPLICATES OpenCV_INCLUDE_DIRS)

set(OpenCV_VERSION)
if(OpenCV_INCLUDE_DIR)
  file(STRINGS ${OpenCV_INCLUDE_DIR}/opencv2/core/version.hpp lines REGEX "define CV_VERSION_(MAJOR|MINOR|REVISION) ")
  string(REGEX MATCHALL "[0-9]+" numbers "${lines}")
  list(JOIN numbers "." OpenCV_VERSION)
endif()

foreach(component IN LISTS OpenCV_FIND_COMPONENTS)
  find_library(OpenCV_${component}_LIBRARY opencv_${component})
  find_path(OpenCV_${component}_HEADER opencv2/${component}.hpp HINTS ${OpenCV_INCLUDE_DIR})
  mark_as_advanced(OpenCV_${component}_LIBRARY OpenCV_${component}_HEADER)
  if(OpenCV_${component}_LIBRARY AND OpenCV_${component}_HEADER AND OpenCV_MODULES_INCLUDE_DIR)
    set(OpenCV_${component}_FOUND TRUE)
    if(NOT TARGET OpenCV::${component})
      add_library(OpenCV::${component} UNKNOWN IMPORTED)
      set_target_properties(OpenCV::${component} PROPERTIES
        IMPORTED_LOCATION ${OpenCV_${component}_LIBRARY}
        INTERFACE_INCLUDE_DIRECTORIES "${OpenCV_INCLUDE_DIRS}")
      if(NOT component STREQUAL "core")
        set_property(TARGET OpenCV::${component} PROPERTY INTERFACE_LINK_LIBRARIES OpenCV::core)
      endif()
    endif()
  endif()
endforeach()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenCV
  REQUIRED_VARS OpenCV_INCLUDE_DIR OpenCV_MODULES_INCLUDE_DIR
  VERSION_VAR OpenCV_VERSION
  HANDLE_COMPONENTS)
