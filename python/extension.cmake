# The extension rths._rths, target rths_python, for the Python that find_package(Python) found.

# Older ones misread the arrays of NumPy 2; Debian 12 has 2.10.
find_package(pybind11 2.13 CONFIG QUIET)
if(NOT pybind11_FOUND)
  include(${CMAKE_CURRENT_LIST_DIR}/../cmake/FetchWheel.cmake)
  rths_fetch_wheel(pybind11 pybind11 pybind11==3.0.1 aa8f0aa6e0a94d3b64adfc38f560f33f15e589be2175e103c0a33c6bce55ee89)
  find_package(pybind11 2.13 CONFIG REQUIRED PATHS ${pybind11}/pybind11 NO_DEFAULT_PATH)
endif()

set(sources conversions.cpp module.cpp recording.cpp testkit.cpp)
list(TRANSFORM sources PREPEND ${CMAKE_CURRENT_LIST_DIR}/src/)
pybind11_add_module(rths_python MODULE NO_EXTRAS ${sources})
target_link_libraries(rths_python PRIVATE rths::recording rths::testkit fmt::fmt $<TARGET_NAME_IF_EXISTS:rths_warnings>)
target_compile_features(rths_python PRIVATE cxx_std_20)
set_target_properties(rths_python PROPERTIES OUTPUT_NAME _rths)
