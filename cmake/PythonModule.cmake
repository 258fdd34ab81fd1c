# The option GRAINFIELD_PYTHON, on where pybind11 and the interpreter that it is for are found.
#
# Debian's interpreter is taken unless Python_EXECUTABLE says another one: others that come first in PATH have neither
# Debian's numpy nor its pandas.
if(NOT Python_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python_EXECUTABLE /usr/bin/python3)
endif()
set(PYBIND11_FINDPYTHON ON)
find_package(pybind11 2.10 QUIET)
if(PROJECT_IS_TOP_LEVEL AND pybind11_FOUND AND NOT GRAINFIELD_SANITIZE)
  set(python_default ON)
else()
  set(python_default OFF)
endif()
option(GRAINFIELD_PYTHON "Build the Python module" ${python_default})
if(GRAINFIELD_PYTHON AND NOT pybind11_FOUND)
  message(FATAL_ERROR "GRAINFIELD_PYTHON needs pybind11 2.10 or later: scripts/install-dependencies, or -DGRAINFIELD_PYTHON=OFF")
endif()
