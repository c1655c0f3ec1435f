# Generates octomarch/base/build_info.hpp: what `octomarch info` and the metadata of pictures say about the build.
string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type_upper)
list(JOIN OCTOMARCH_FLOAT_FLAGS " " OCTOMARCH_FLAGS)
string(STRIP "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${build_type_upper}} ${OCTOMARCH_FLAGS}" OCTOMARCH_FLAGS)
string(REGEX REPLACE "[\\\"]" "" OCTOMARCH_FLAGS "${OCTOMARCH_FLAGS}")

configure_file("${CMAKE_CURRENT_LIST_DIR}/build_info.hpp.in"
               "${PROJECT_BINARY_DIR}/generated/octomarch/base/build_info.hpp" @ONLY)
add_library(octomarch_build_info INTERFACE)
target_include_directories(octomarch_build_info INTERFACE "${PROJECT_BINARY_DIR}/generated")
