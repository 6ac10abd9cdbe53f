# anthesis_module(<name> SOURCES ... HEADERS ... PUBLIC ... PRIVATE ... TESTS ...)
#
# One idea of the field, one library with its own include root. PUBLIC and PRIVATE name the libraries it stands on: a
# header of any other module is not on the include path, so an include against the arrow does not compile.
# HEADERS are given without their common folder include/anthesis/<name>/; each must compile alone.
function(anthesis_module name)
  cmake_parse_arguments(MODULE "" "" "SOURCES;HEADERS;PUBLIC;PRIVATE;TESTS" ${ARGN})
  set(target anthesis_${name})
  list(TRANSFORM MODULE_HEADERS PREPEND include/anthesis/${name}/)
  add_library(${target} STATIC ${MODULE_SOURCES})
  add_library(anthesis::${name} ALIAS ${target})
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS include FILES ${MODULE_HEADERS})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PUBLIC ${MODULE_PUBLIC} PRIVATE ${MODULE_PRIVATE} $<BUILD_INTERFACE:anthesis::build_flags>)
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} VERIFY_INTERFACE_HEADER_SETS ON)
  set_property(GLOBAL APPEND PROPERTY ANTHESIS_MODULES ${target})
  if(ANTHESIS_TESTS AND MODULE_TESTS)
    add_executable(${name}_test ${MODULE_TESTS})
    target_link_libraries(${name}_test PRIVATE anthesis::${name} anthesis::build_flags GTest::gmock_main)
    target_compile_definitions(${name}_test PRIVATE
      ANTHESIS_SOURCE_DIR="${PROJECT_SOURCE_DIR}" ANTHESIS_REFERENCE_DEFAULT="${PROJECT_SOURCE_DIR}/../shared/reference")
    set_target_properties(${name}_test PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/test)
    gtest_discover_tests(${name}_test TEST_PREFIX "${name}." DISCOVERY_MODE PRE_TEST)
  endif()
endfunction()
