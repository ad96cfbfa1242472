# What `cmake --install` puts where: the program with its man pages and completion, the library with its headers and what
# find_package(moiregauge) reads, and the licences.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/moiregauge)

# Man pages and completion are the program's own words.
file(GLOB page_files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/docs/cli/*.md)
set(words_dir ${PROJECT_BINARY_DIR}/words)
set(word_commands)
set(word_files)
foreach(page IN LISTS page_files)
  get_filename_component(name ${page} NAME_WE)
  set(title moiregauge-${name})
  if(name STREQUAL moiregauge)
    set(title moiregauge)
  endif()
  list(APPEND word_commands COMMAND moiregauge help --man ${name} > ${words_dir}/man/${title}.1)
  list(APPEND word_commands COMMAND gzip -9nf ${words_dir}/man/${title}.1)
  list(APPEND word_files ${words_dir}/man/${title}.1.gz)
endforeach()
add_custom_command(
  OUTPUT ${word_files} ${words_dir}/bash/moiregauge ${words_dir}/zsh/_moiregauge
  COMMAND ${CMAKE_COMMAND} -E make_directory ${words_dir}/man ${words_dir}/bash ${words_dir}/zsh
  ${word_commands}
  COMMAND moiregauge completion bash > ${words_dir}/bash/moiregauge
  COMMAND moiregauge completion zsh > ${words_dir}/zsh/_moiregauge
  DEPENDS moiregauge
  COMMENT "Man pages and completion"
  VERBATIM)
# Part of every build that may be installed; an instrumented program need not write them.
set(with_all ALL)
if(MOIREGAUGE_SANITIZE OR MOIREGAUGE_FUZZ OR MOIREGAUGE_TSAN)
  set(with_all)
endif()
add_custom_target(words ${with_all} DEPENDS ${word_files} ${words_dir}/bash/moiregauge ${words_dir}/zsh/_moiregauge)

install(TARGETS moiregauge RUNTIME)
install(FILES ${word_files} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${words_dir}/bash/moiregauge DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${words_dir}/zsh/_moiregauge DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/moiregauge)
install(FILES ${PROJECT_SOURCE_DIR}/cmake/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/moiregauge)

# The library: one archive per module, as moiregauge::<module>; moiregauge::moiregauge is all of them.
get_property(modules GLOBAL PROPERTY MOIREGAUGE_PUBLIC_MODULES)
set(libraries)
add_library(moiregauge_all INTERFACE)
set_target_properties(moiregauge_all PROPERTIES EXPORT_NAME moiregauge)
foreach(module IN LISTS modules)
  set_target_properties(moiregauge_${module} PROPERTIES EXPORT_NAME ${module})
  list(APPEND libraries moiregauge_${module})
endforeach()
target_link_libraries(moiregauge_all INTERFACE ${libraries})
install(TARGETS moiregauge_all ${libraries} moiregauge_opencv moiregauge_libav moiregauge_cairo moiregauge_png moiregauge_crypto
                moiregauge_images moiregauge_hdf5
        EXPORT moiregauge-targets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/moiregauge
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
foreach(module IN LISTS modules)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/moiregauge/${module} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/moiregauge
          FILES_MATCHING PATTERN "*.h" PATTERN "*-inl.h" EXCLUDE PATTERN "*_for_test*.h" EXCLUDE PATTERN "test_*.h" EXCLUDE)
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/generated/moiregauge/version.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/moiregauge)
install(EXPORT moiregauge-targets NAMESPACE moiregauge:: DESTINATION ${package_dir})
configure_package_config_file(cmake/moiregauge-config.cmake.in ${PROJECT_BINARY_DIR}/moiregauge-config.cmake
                              INSTALL_DESTINATION ${package_dir})
# Before version 1 any minor version may change the library.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/moiregauge-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/moiregauge-config.cmake ${PROJECT_BINARY_DIR}/moiregauge-config-version.cmake
        DESTINATION ${package_dir})
# CMake strips programs, not archives; their debugging information is ten times their code.
install(CODE "
  if(CMAKE_INSTALL_DO_STRIP)
    file(GLOB archives \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/moiregauge/*.a\")
    execute_process(COMMAND ${CMAKE_STRIP} --strip-debug \${archives} COMMAND_ERROR_IS_FATAL ANY)
  endif()")
