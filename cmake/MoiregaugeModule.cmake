# moiregauge_precompiled(target name options...) gives the target the headers that most files include, compiled once as
# library `name` with the target's own options. It saves a sixth of the processor time. Not for a compiler cache, which
# would not find such files again, and only where files are compiled several at once: the other builds show an include
# that is missing in a file.
function(moiregauge_precompiled target name)
  if(NOT MOIREGAUGE_UNITY OR CMAKE_CXX_COMPILER_LAUNCHER)
    return()
  endif()
  if(NOT TARGET ${name})
    file(WRITE ${PROJECT_BINARY_DIR}/generated/${name}.cc "")
    add_library(${name} OBJECT ${PROJECT_BINARY_DIR}/generated/${name}.cc)
    target_link_libraries(${name} PRIVATE Eigen3::Eigen tl::expected fmt::fmt moiregauge_warnings)
    target_compile_options(${name} PRIVATE ${ARGN})
    target_precompile_headers(${name} PRIVATE <algorithm> <array> <cmath> <filesystem> <functional> <map> <memory> <optional>
                              <span> <string> <string_view> <utility> <vector> <Eigen/Cholesky> <Eigen/Core> <Eigen/LU> <tl/expected.hpp>
                              <fmt/format.h>)
  endif()
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:Eigen3::Eigen> $<BUILD_INTERFACE:tl::expected>
                        $<BUILD_INTERFACE:fmt::fmt>)
  target_precompile_headers(${target} REUSE_FROM ${name})
endfunction()

# moiregauge_module(NAME name [PRIVATE] [QUICK_COMPILE] LINK libs... TEST_LINK libs... [TEST_LOCK name]) adds the library and the tests of
# src/moiregauge/<name>. All *_test.cc files are part of <name>_test, all other *.cc files of the static library
# moiregauge_<name>. Unless PRIVATE, it is installed as moiregauge::<name> with its headers (cmake/Install.cmake).
# TEST_LOCK: tests with the same lock run one at a time, because they share something on this computer.
# QUICK_COMPILE: no loop over pixels or samples is in it, so -O1 suffices, which takes a quarter less time to compile.
function(moiregauge_module)
  cmake_parse_arguments(ARG "PRIVATE;QUICK_COMPILE" "NAME;TEST_LOCK" "LINK;TEST_LINK" ${ARGN})
  set(dir ${PROJECT_SOURCE_DIR}/src/moiregauge/${ARG_NAME})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${dir}/*.cc)
  set(tests ${sources})
  list(FILTER sources EXCLUDE REGEX "_(test|main)\\.cc$")
  list(FILTER tests INCLUDE REGEX "_test\\.cc$")
  set(lib moiregauge_${ARG_NAME})
  if(sources)
    add_library(${lib} STATIC ${sources})
    target_include_directories(${lib} PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src;${PROJECT_BINARY_DIR}/generated>")
    target_link_libraries(${lib} PUBLIC ${ARG_LINK} PRIVATE $<BUILD_INTERFACE:moiregauge_warnings>)
    if(ARG_QUICK_COMPILE)
      target_compile_options(${lib} PRIVATE $<$<CONFIG:RelWithDebInfo>:-O1>)
      moiregauge_precompiled(${lib} moiregauge_quick_headers $<$<CONFIG:RelWithDebInfo>:-O1>)
    else()
      moiregauge_precompiled(${lib} moiregauge_headers)
    endif()
  else()
    add_library(${lib} INTERFACE)
    target_include_directories(${lib} INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>)
    target_link_libraries(${lib} INTERFACE ${ARG_LINK})
  endif()
  if(NOT ARG_PRIVATE)
    set_property(GLOBAL APPEND PROPERTY MOIREGAUGE_PUBLIC_MODULES ${ARG_NAME})
  endif()
  if(tests AND BUILD_TESTING)
    add_executable(${ARG_NAME}_test ${tests})
    target_link_libraries(${ARG_NAME}_test PRIVATE ${lib} ${ARG_TEST_LINK} moiregauge_warnings GTest::gtest_main)
    target_compile_definitions(${ARG_NAME}_test PRIVATE MOIREGAUGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    set(lock "")
    if(ARG_TEST_LOCK)
      set(lock RESOURCE_LOCK ${ARG_TEST_LOCK})
    endif()
    gtest_discover_tests(${ARG_NAME}_test TEST_PREFIX "${ARG_NAME}." DISCOVERY_TIMEOUT 60 PROPERTIES LABELS unit ${lock}
                         ENVIRONMENT "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/lsan.supp:print_suppressions=0")
  endif()
endfunction()
