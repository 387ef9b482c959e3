include(${CMAKE_CURRENT_LIST_DIR}/RthsDependencies.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/rthsTargets.cmake)
