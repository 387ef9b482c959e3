include(GNUInstallDirs)

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)

option(RTHS_WERROR "Treat warnings as errors; for developers of rths only" OFF)
option(RTHS_TESTS "Build the tests" ${PROJECT_IS_TOP_LEVEL})
option(RTHS_VECTOR_COPIES "Copy tear groups with vector instructions if the processor has them" ON)
option(RTHS_UNITY "Compile a dozen sources at once, with precompiled headers: a third of the time" OFF)
set(RTHS_BATCH 12 CACHE STRING "Sources of a library that are compiled at once with RTHS_UNITY; 0: all of them")
option(RTHS_BENCHMARKS "Build rths-bench and the programs that the ring is compared with; their tests need RTHS_TESTS, too" ${RTHS_TESTS})
option(RTHS_PYTHON "Build the Python package" OFF)
set(RTHS_SANITIZER "" CACHE STRING "Sanitizers, as the argument of -fsanitize")

# Warnings apply to sources of this project only, not to programs that link to it.
add_library(rths_warnings INTERFACE)
target_compile_options(rths_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wcast-align
  $<$<COMPILE_LANGUAGE:CXX>:-Wold-style-cast>
  # Part of -Wconversion in clang, but not in g++; of little use for indices.
  $<$<CXX_COMPILER_ID:Clang>:-Wno-sign-conversion>
  $<$<BOOL:${RTHS_WERROR}>:-Werror>)

if(RTHS_UNITY AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  # The compiler collects no garbage below 500 MB: this takes 7 % of its time.
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:--param=ggc-min-heapsize=500000>)
endif()

if(RTHS_SANITIZER)
  add_compile_options(-fsanitize=${RTHS_SANITIZER} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${RTHS_SANITIZER})
  add_compile_definitions(RTHS_SANITIZED)
  if(RTHS_SANITIZER STREQUAL "thread")
    add_compile_definitions(__SANITIZE_THREAD__=1)  # g++ defines it, clang does not
  endif()
endif()
