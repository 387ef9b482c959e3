# rths_add(<folder> [INTERNAL] [SEPARATE] [MATHS] SOURCES <files> [DEPENDS <targets>] [PRIVATE <targets>])
#
# One folder, one target: library rths_<folder>, alias rths::<folder>, public headers below include/.
# Each include/ is a separate root, so includes from a folder that is not in DEPENDS do not compile.
# INTERNAL libraries are not installed; only programs of this project use them.
# SEPARATE sources are never compiled together, because their third-party headers clash.
# MATHS libraries are optimized under sanitizers too: without, their tests take ten times as long.
function(rths_add folder)
  cmake_parse_arguments(PARSE_ARGV 1 arg "INTERNAL;SEPARATE;MATHS" "" "SOURCES;DEPENDS;PRIVATE")
  set(target rths_${folder})
  add_library(${target} ${arg_SOURCES})
  add_library(rths::${folder} ALIAS ${target})
  file(GLOB_RECURSE headers ${CMAKE_CURRENT_SOURCE_DIR}/include/*.hpp
       ${CMAKE_CURRENT_SOURCE_DIR}/include/*.h)
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS include FILES ${headers})
  target_link_libraries(${target} PUBLIC ${arg_DEPENDS} PRIVATE ${arg_PRIVATE} $<BUILD_INTERFACE:rths_warnings>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${folder} POSITION_INDEPENDENT_CODE ON)
  if(NOT arg_SEPARATE)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ${RTHS_UNITY} UNITY_BUILD_BATCH_SIZE ${RTHS_BATCH})
  endif()
  if(arg_MATHS AND RTHS_SANITIZER)
    target_compile_options(${target} PRIVATE -O2)
  else()
    rths_use_precompiled(${target} rths_library_headers)
  endif()
  if(NOT arg_INTERNAL)
    install(TARGETS ${target} EXPORT rths FILE_SET HEADERS)
    add_dependencies(rths_installed ${target})
  endif()
endfunction()

# rths_test(<folder> [MATHS] [SEPARATE] SOURCES <files> [DEPENDS <targets>] [LABEL <label>] [TIMEOUT <seconds>]
#           [THREADS <patterns of tests>] [NOT_SANITIZED <reason>])
#
# The tests of a folder as one executable; each TEST is a ctest case. MATHS tests are optimized, as are those with the
# label physics or realtime: the linker may take their copy of a template for the libraries too. The target rths_tested
# builds all that are registered.
#
# THREADS: tests in which threads of one process share data. The thread sanitizer runs these alone: it sees no other process,
# and finds nothing in one thread. NOT_SANITIZED: no sanitizer runs the target, for this reason.
function(rths_test folder)
  cmake_parse_arguments(PARSE_ARGV 1 arg "MATHS;SEPARATE" "LABEL;TIMEOUT;NOT_SANITIZED" "SOURCES;DEPENDS;THREADS")
  set(target rths_${folder}_test)
  add_executable(${target} ${arg_SOURCES})
  if(NOT arg_SEPARATE)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ${RTHS_UNITY} UNITY_BUILD_BATCH_SIZE 16)
  endif()
  target_link_libraries(${target} PRIVATE ${arg_DEPENDS} rths_test_support rths_warnings
                                          GTest::gtest_main)
  if("nlohmann_json::nlohmann_json" IN_LIST arg_DEPENDS)
    target_link_libraries(${target} PRIVATE rths_test_json)
  endif()
  if(arg_MATHS OR arg_LABEL MATCHES "physics|realtime")
    rths_compile_test(${target} rths_maths_test_headers -O1)
  else()
    # Built more often than run; the libraries have the preset's optimization.
    rths_compile_test(${target} rths_test_headers -O0)
  endif()
  if(arg_LABEL STREQUAL "realtime" AND NOT arg_NOT_SANITIZED)
    set(arg_NOT_SANITIZED "in real time, for which a sanitizer is too slow")
  endif()
  rths_reason_not_to_run("${arg_THREADS}" "${arg_NOT_SANITIZED}" reason)
  if(reason)
    set_target_properties(${target} PROPERTIES EXCLUDE_FROM_ALL ON)
    file(APPEND ${CMAKE_BINARY_DIR}/not_run.txt "${folder}: ${reason}\n")
    return()
  endif()
  add_dependencies(rths_tested ${target})
  rths_list_test(${target} ${arg_SOURCES})
  if(NOT arg_LABEL)
    set(arg_LABEL unit)
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 120)
  endif()
  math(EXPR arg_TIMEOUT "${arg_TIMEOUT} * ${RTHS_SLOWNESS}")
  set(environment)
  if(RTHS_SANITIZER)
    set(environment
        ENVIRONMENT "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/leaks_on_purpose.txt:print_suppressions=0")
  endif()
  set(filter)
  if(RTHS_SANITIZER STREQUAL "thread")
    list(JOIN arg_THREADS ":" filter)
    set(filter TEST_FILTER ${filter})
  endif()
  gtest_discover_tests(${target} DISCOVERY_TIMEOUT 60 ${filter}
                       PROPERTIES LABELS ${arg_LABEL} TIMEOUT ${arg_TIMEOUT} ${environment})
endfunction()

# Why the sanitizer of this build does not run a target; empty: it runs it.
function(rths_reason_not_to_run threads not_sanitized result)
  set(reason)
  if(RTHS_SANITIZER AND not_sanitized)
    set(reason "${not_sanitized}")
  elseif(RTHS_SANITIZER STREQUAL "thread" AND NOT threads)
    set(reason "declares no tests of threads, THREADS")
  endif()
  set(${result} "${reason}" PARENT_SCOPE)
endfunction()

# Under sanitizers, all tests have the preset's optimization.
function(rths_compile_test target headers optimization)
  if(RTHS_SANITIZER)
    set(headers rths_test_headers)
  else()
    target_compile_options(${target} PRIVATE ${optimization})
  endif()
  rths_use_precompiled(${target} ${headers})
endfunction()

# Adds "<folder of tests/> <target>" to tests.txt, from which `./lab test FOLDER` takes its targets: for each folder with
# tests among the sources. support/ serves all of them.
function(rths_list_test target)
  set(folders)
  foreach(source IN LISTS ARGN)
    get_filename_component(source ${source} ABSOLUTE)
    file(RELATIVE_PATH source ${PROJECT_SOURCE_DIR}/tests ${source})
    if(source MATCHES "^([^/]+)/.*_test\\.(cpp|py)$")
      list(APPEND folders ${CMAKE_MATCH_1})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES folders)
  list(REMOVE_ITEM folders support)
  foreach(folder IN LISTS folders)
    file(APPEND ${CMAKE_BINARY_DIR}/tests.txt "${folder} ${target}\n")
  endforeach()
endfunction()

# rths_list_scripts(<folder> <suite>…): the same for tests without a program. The target rths_<suite>_test builds what
# add_dependencies gives it; ctest runs <suite>.<test>.
function(rths_list_scripts folder)
  foreach(suite IN LISTS ARGN)
    add_custom_target(rths_${suite}_test)
    file(APPEND ${CMAKE_BINARY_DIR}/tests.txt "${folder} rths_${suite}_test\n")
  endforeach()
endfunction()
