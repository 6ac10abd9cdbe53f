# cmake --install: the libraries and their headers as the package `anthesis`, the program, the species files.
#
#   find_package(anthesis REQUIRED)
#   target_link_libraries(mine PRIVATE anthesis::anthesis)      # or one module: anthesis::phyllotaxis
get_property(modules GLOBAL PROPERTY ANTHESIS_MODULES)

add_library(anthesis_all INTERFACE)
add_library(anthesis::anthesis ALIAS anthesis_all)
set_target_properties(anthesis_all PROPERTIES EXPORT_NAME anthesis)
target_link_libraries(anthesis_all INTERFACE ${modules})

install(TARGETS ${modules} anthesis_all EXPORT anthesis-targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS anthesis_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/species DESTINATION ${CMAKE_INSTALL_DATADIR}/anthesis
  FILES_MATCHING PATTERN "*.toml" PATTERN "*.json")
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/anthesis)
install(EXPORT anthesis-targets NAMESPACE anthesis:: DESTINATION ${package_folder})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/anthesis-config.cmake.in
  ${PROJECT_BINARY_DIR}/anthesis-config.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/anthesis-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/anthesis-config.cmake ${PROJECT_BINARY_DIR}/anthesis-config-version.cmake
  DESTINATION ${package_folder})
