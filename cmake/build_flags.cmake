# Flags for our own code, private to each target so that they never reach a user's.
add_library(anthesis_build_flags INTERFACE)
add_library(anthesis::build_flags ALIAS anthesis_build_flags)

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

# Assertions stay on wherever debug information is wanted, and so under the sanitizers too: CMake's own default for
# RelWithDebInfo would switch them off.
string(REPLACE "-DNDEBUG" "" CMAKE_CXX_FLAGS_RELWITHDEBINFO "${CMAKE_CXX_FLAGS_RELWITHDEBINFO}")

target_compile_features(anthesis_build_flags INTERFACE cxx_std_20)
target_compile_options(anthesis_build_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  # The same bits on every processor: no fused multiply-add behind our back, no reordering of sums.
  -ffp-contract=off -fno-fast-math)
if(ANTHESIS_WERROR)
  target_compile_options(anthesis_build_flags INTERFACE -Werror)
endif()
if(ANTHESIS_SANITIZE)
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_compile_definitions(_GLIBCXX_ASSERTIONS)  # spans and vectors within memory that is theirs
  add_link_options(-fsanitize=address,undefined)
endif()
