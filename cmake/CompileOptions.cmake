# What every target of the project is compiled with: octomarch_options. Instruction sets are added by Isa.cmake.

# -ffp-contract=off: GCC otherwise fuses multiply and add where the target can, and instruction sets disagree in bits.
# -fno-math-errno: sqrt is one instruction, without a call that only sets errno; values are unchanged.
set(OCTOMARCH_FLOAT_FLAGS -ffp-contract=off -fno-math-errno)

foreach(flags IN ITEMS "${CMAKE_CXX_FLAGS}" "${CMAKE_SHARED_LINKER_FLAGS}" "${CMAKE_MODULE_LINKER_FLAGS}")
  if(flags MATCHES "-ffast-math|-Ofast|-funsafe-math-optimizations")
    message(FATAL_ERROR "octomarch cannot be built with ${CMAKE_MATCH_0}: results would differ between processors, and "
                        "linking with it switches the whole process to flush-to-zero. It is in CXXFLAGS or LDFLAGS.")
  endif()
endforeach()

add_library(octomarch_options INTERFACE)
target_compile_options(octomarch_options INTERFACE ${OCTOMARCH_FLOAT_FLAGS} -Wall -Wextra -Wpedantic -Wconversion)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # False alarms of GCC 12: std::sort of a short std::array as out of bounds, and "text" + std::string as an overlapping
  # copy, https://gcc.gnu.org/bugzilla/show_bug.cgi?id=105651
  target_compile_options(octomarch_options INTERFACE -Wno-restrict -Wno-array-bounds)
endif()
if(OCTOMARCH_WERROR)
  target_compile_options(octomarch_options INTERFACE -Werror)
endif()
if(OCTOMARCH_SANITIZE)
  target_compile_options(octomarch_options INTERFACE
    -fsanitize=${OCTOMARCH_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(octomarch_options INTERFACE -fsanitize=${OCTOMARCH_SANITIZE})
endif()
