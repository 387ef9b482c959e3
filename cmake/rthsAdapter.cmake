# find_package(rths COMPONENTS adapter): all that an adapter in a shared library needs. It links to nothing.
#   rths::adapter       the headers rths_adapter.h and rths_adapter.hpp
#   rths_COMMAND        path of the command rths
#   rths_add_adapter(<name> <sources>)   a library <name>.so that exports its adapter alone
set(rths_prefix ${CMAKE_CURRENT_LIST_DIR})
while(NOT EXISTS ${rths_prefix}/include/rths_adapter.h AND NOT rths_prefix STREQUAL "/")
  cmake_path(GET rths_prefix PARENT_PATH rths_prefix)
endwhile()
set(rths_COMMAND ${rths_prefix}/bin/rths)
set(rths_adapter_exports ${CMAKE_CURRENT_LIST_DIR}/exports.map)
if(NOT TARGET rths::adapter)
  add_library(rths::adapter INTERFACE IMPORTED)
  target_include_directories(rths::adapter INTERFACE ${rths_prefix}/include)
endif()

function(rths_add_adapter name)
  add_library(${name} MODULE ${ARGN})
  target_link_libraries(${name} PRIVATE rths::adapter)
  target_compile_features(${name} PRIVATE c_std_11)
  if(CMAKE_CXX_COMPILER_LOADED)
    target_compile_features(${name} PRIVATE cxx_std_20)
  endif()
  target_link_options(${name} PRIVATE -Wl,--version-script=${rths_adapter_exports})
  set_target_properties(${name} PROPERTIES PREFIX "" LINK_DEPENDS ${rths_adapter_exports})
endfunction()
