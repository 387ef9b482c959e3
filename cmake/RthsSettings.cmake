include(GNUInstallDirs)

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)

option(RTHS_WERROR "Treat warnings as errors: for those who work on rths, never for its users" OFF)
option(RTHS_TESTS "Build the tests" ${PROJECT_IS_TOP_LEVEL})
option(RTHS_VECTOR_COPIES "Copy tear groups with vector instructions where there are any" ON)
option(RTHS_BENCHMARKS "Build the benchmarks, and the peers that the ring is held against" OFF)
set(RTHS_SANITIZER "" CACHE STRING "Sanitizers to build with, as -fsanitize takes them")

# Warnings are for this project's own sources and are not handed to those who link to it.
add_library(rths_warnings INTERFACE)
target_compile_options(rths_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wcast-align
  $<$<COMPILE_LANGUAGE:CXX>:-Wold-style-cast>
  # clang counts these to -Wconversion, g++ does not; of an index they say nothing worth knowing.
  $<$<CXX_COMPILER_ID:Clang>:-Wno-sign-conversion>
  $<$<BOOL:${RTHS_WERROR}>:-Werror>)

if(RTHS_SANITIZER)
  add_compile_options(-fsanitize=${RTHS_SANITIZER} -fno-omit-frame-pointer -g)
  add_link_options(-fsanitize=${RTHS_SANITIZER})
endif()
