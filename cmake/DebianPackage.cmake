# `cpack` in the build folder makes one .deb: the program, the Python module if it is built, samples of configurations.
# Libraries and headers are for `cmake --install`.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/data-samples/ COMPONENT program
  DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/grainfield/examples FILES_MATCHING PATTERN "*.toml")
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE COMPONENT program
  DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/grainfield RENAME copyright)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS gnuplot-nox)
if(GRAINFIELD_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
  # The compiled part is for one version of Python.
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PACKAGE_DEPENDS
    "python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next_minor}), python3-numpy")
  string(APPEND CPACK_DEBIAN_PACKAGE_RECOMMENDS ", python3-pandas, python3-xarray")
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_PACKAGE_NAME grainfield)
set(CPACK_PACKAGE_CONTACT "the authors of grainfield, see CITATION.cff <grainfield@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
include(CPack)
