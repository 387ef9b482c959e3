if("adapter" IN_LIST rths_FIND_COMPONENTS)
  include(${CMAKE_CURRENT_LIST_DIR}/rthsAdapter.cmake)
  set(rths_adapter_FOUND TRUE)
endif()
# Adapters alone need none of the libraries.
if(NOT rths_FIND_COMPONENTS STREQUAL "adapter")
  include(${CMAKE_CURRENT_LIST_DIR}/RthsDependencies.cmake)
  include(${CMAKE_CURRENT_LIST_DIR}/rthsTargets.cmake)
endif()
