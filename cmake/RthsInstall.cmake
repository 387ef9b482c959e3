# find_package(rths) provides rths::core … rths::report with their dependencies.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/rths)
install(EXPORT rths NAMESPACE rths:: FILE rthsTargets.cmake DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/rthsConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES cmake/rthsConfig.cmake cmake/RthsDependencies.cmake cmake/rthsAdapter.cmake cmake/rthsTest.cmake adapters/plugin/exports.map
              ${CMAKE_BINARY_DIR}/rthsConfigVersion.cmake
        DESTINATION ${package_dir})
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DATADIR}/rths)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
