# rths_add(<folder> [INTERNAL] [SEPARATE] SOURCES <files> [DEPENDS <targets>] [PRIVATE <targets>])
#
# One folder, one target: library rths_<folder>, alias rths::<folder>, public headers below include/.
# Each include/ is a separate root, so includes from a folder that is not in DEPENDS do not compile.
# INTERNAL libraries are not installed; only programs of this project use them.
# SEPARATE sources are never compiled together, because their third-party headers clash.
function(rths_add folder)
  cmake_parse_arguments(PARSE_ARGV 1 arg "INTERNAL;SEPARATE" "" "SOURCES;DEPENDS;PRIVATE")
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
    set_target_properties(${target} PROPERTIES UNITY_BUILD ${RTHS_UNITY} UNITY_BUILD_BATCH_SIZE 12)
  endif()
  if(NOT arg_INTERNAL)
    install(TARGETS ${target} EXPORT rths FILE_SET HEADERS)
  endif()
endfunction()

# rths_test(<folder> [PURE] SOURCES <files> [DEPENDS <targets>] [LABEL <label>])
#
# The tests of a folder as one executable; each TEST is a ctest case. PURE tests are independent maths.
# Under sanitizers, where processes start slowly, they run as four cases.
function(rths_test folder)
  cmake_parse_arguments(PARSE_ARGV 1 arg "PURE" "LABEL" "SOURCES;DEPENDS")
  set(target rths_${folder}_test)
  add_executable(${target} ${arg_SOURCES})
  target_link_libraries(${target} PRIVATE ${arg_DEPENDS} rths_test_support rths_warnings
                                          GTest::gtest_main)
  # Faster compilation: tests use -O1, the tested libraries the optimization of the preset.
  target_compile_options(${target} PRIVATE -O1)
  if(NOT arg_LABEL)
    set(arg_LABEL unit)
  endif()
  if(arg_PURE AND RTHS_SANITIZER)
    foreach(shard RANGE 3)
      add_test(NAME ${target}_${shard} COMMAND ${target})
      set_tests_properties(${target}_${shard} PROPERTIES LABELS ${arg_LABEL} TIMEOUT 600
        ENVIRONMENT "GTEST_TOTAL_SHARDS=4;GTEST_SHARD_INDEX=${shard}")
    endforeach()
    return()
  endif()
  set(alone OFF)
  if(arg_LABEL STREQUAL realtime)
    set(alone ON)
  endif()
  gtest_discover_tests(${target} DISCOVERY_TIMEOUT 60
                       PROPERTIES LABELS ${arg_LABEL} TIMEOUT 120 RUN_SERIAL ${alone})
endfunction()
