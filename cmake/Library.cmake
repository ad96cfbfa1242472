# The library for other programs: include/moiregauge and two libraries that implement it.
#   moiregauge::moiregauge       shared; all of the public headers
#   moiregauge::sampling_moire   static; sampling_moire.h alone, with no other dependency
set(library_dir ${PROJECT_SOURCE_DIR}/src/moiregauge/library)
file(GLOB library_sources CONFIGURE_DEPENDS ${library_dir}/*.cc)
list(FILTER library_sources EXCLUDE REGEX "_(test|main)\\.cc$")
add_library(moiregauge_library SHARED ${library_sources})
set_target_properties(moiregauge_library PROPERTIES OUTPUT_NAME moiregauge EXPORT_NAME moiregauge VERSION ${PROJECT_VERSION}
                      SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
# A class of its anonymous namespace is a member of Tracker::State, which GCC reports in a batch.
set_source_files_properties(${library_dir}/tracker.cc PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
target_compile_options(moiregauge_library PRIVATE $<$<CONFIG:RelWithDebInfo>:-O1>)
moiregauge_precompiled(moiregauge_library moiregauge_quick_headers $<$<CONFIG:RelWithDebInfo>:-O1>)
target_include_directories(moiregauge_library
  PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include;${PROJECT_BINARY_DIR}/generated>"
  PRIVATE ${PROJECT_SOURCE_DIR}/src)
target_link_libraries(moiregauge_library PUBLIC tl::expected PRIVATE moiregauge_app moiregauge_simulator moiregauge_warnings)
target_link_options(moiregauge_library PRIVATE -Wl,--exclude-libs,ALL -Wl,--no-undefined)

# The library may be loaded into a program of another language, so it decodes in a program of its own.
add_executable(moiregauge_decode ${library_dir}/decode_main.cc)
set_target_properties(moiregauge_decode PROPERTIES OUTPUT_NAME moiregauge-decode INSTALL_RPATH "$ORIGIN/.."
                      RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/moiregauge)
target_link_libraries(moiregauge_decode PRIVATE moiregauge_library moiregauge_warnings)

file(GLOB sampling_moire_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/moiregauge/phase/sampling_moire/*.cc)
list(FILTER sampling_moire_sources EXCLUDE REGEX "_test\\.cc$")
add_library(moiregauge_sampling_moire STATIC ${library_dir}/sampling_moire.cc ${sampling_moire_sources})
set_target_properties(moiregauge_sampling_moire PROPERTIES EXPORT_NAME sampling_moire)
target_include_directories(moiregauge_sampling_moire
  PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include;${PROJECT_BINARY_DIR}/generated>"
  PRIVATE ${PROJECT_SOURCE_DIR}/src)
target_link_libraries(moiregauge_sampling_moire PUBLIC tl::expected PRIVATE $<BUILD_INTERFACE:moiregauge_warnings>)

if(BUILD_TESTING)
  file(GLOB library_tests CONFIGURE_DEPENDS ${library_dir}/*_test.cc)
  add_executable(library_test ${library_tests})
  target_link_libraries(library_test PRIVATE moiregauge_library moiregauge_warnings GTest::gtest_main)
  gtest_discover_tests(library_test TEST_PREFIX "library." DISCOVERY_TIMEOUT 60 PROPERTIES LABELS unit)
endif()
