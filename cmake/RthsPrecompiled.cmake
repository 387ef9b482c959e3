# Headers that most sources include, parsed once for all libraries and once for all tests. Only with RTHS_UNITY: other
# builds show which source lacks an include.
set(rths_common_headers
  algorithm array atomic chrono cmath complex filesystem fstream functional map memory mutex numbers optional random
  set span sstream string string_view thread utility vector Eigen/Core fmt/format.h)

# rths_precompiled(<name> <target>… HEADERS <more headers>): the object library <name> that carries the headers, with
# the include folders and definitions of the targets.
function(rths_precompiled name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "HEADERS")
  file(WRITE ${CMAKE_BINARY_DIR}/${name}.cpp "")
  add_library(${name} OBJECT EXCLUDE_FROM_ALL ${CMAKE_BINARY_DIR}/${name}.cpp)
  target_link_libraries(${name} PRIVATE fmt::fmt Eigen3::Eigen rths_warnings ${arg_UNPARSED_ARGUMENTS})
  target_compile_features(${name} PRIVATE cxx_std_20)
  set(headers ${rths_common_headers} ${arg_HEADERS})
  list(TRANSFORM headers REPLACE "(.+)" "<\\1>")
  target_precompile_headers(${name} PRIVATE ${headers})
endfunction()

# rths_use_precompiled(<target> <name>): the options of the target must be those of <name>. CMake allows no sources in C.
function(rths_use_precompiled target name)
  get_target_property(sources ${target} SOURCES)
  if(RTHS_UNITY AND NOT sources MATCHES "\\.c(;|$)")
    target_precompile_headers(${target} REUSE_FROM ${name})
    # The compiler requires the macros of the headers.
    target_compile_definitions(${target} PRIVATE $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
  endif()
endfunction()
