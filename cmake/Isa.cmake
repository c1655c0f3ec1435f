# The instruction sets this target and compiler can be built for: OCTOMARCH_ISAS, and for each an interface target
# octomarch_isa_options_<isa> with its compile options. Benchmarks use them too, so that comparisons share their flags.
include(CheckCXXCompilerFlag)

# scalar is one lane at a time, so that it shows what packets gain: the compiler must not vectorise it behind our back.
set(isa_flags_scalar -fno-tree-vectorize -fno-tree-slp-vectorize)
set(isa_flags_sse2 "")
# BMI and POPCNT come with every AVX2 processor; without them GCC does integer and-not in mask registers.
set(isa_flags_avx2 -mavx2 -mbmi -mbmi2 -mpopcnt)
set(isa_flags_avx512 -mbmi -mbmi2 -mpopcnt -mavx512f -mavx512cd -mavx512dq -mavx512bw -mavx512vl)
set(isa_flags_neon "")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12 takes its own AVX-512 intrinsics for uninitialised: https://gcc.gnu.org/bugzilla/show_bug.cgi?id=105593
  list(APPEND isa_flags_avx512 -Wno-uninitialized -Wno-maybe-uninitialized)
endif()

if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  set(isa_candidates scalar sse2 avx2 avx512)
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$")
  set(isa_candidates scalar neon)
else()
  set(isa_candidates scalar)
endif()

# Kernels are flattened into few large functions, which GCC takes minutes to optimise with a sanitizer's checks in them.
set(isa_optimisation $<$<CONFIG:Release>:-O3>)
if(OCTOMARCH_SANITIZE)
  set(isa_optimisation -O0)
endif()

set(OCTOMARCH_ISAS "")
foreach(isa IN LISTS isa_candidates)
  list(JOIN isa_flags_${isa} " " flags)
  check_cxx_compiler_flag("${flags}" OCTOMARCH_COMPILER_TARGETS_${isa})
  if(OCTOMARCH_COMPILER_TARGETS_${isa})
    list(APPEND OCTOMARCH_ISAS ${isa})
    add_library(octomarch_isa_options_${isa} INTERFACE)
    target_compile_options(octomarch_isa_options_${isa} INTERFACE
      ${isa_optimisation} -fvisibility=hidden ${isa_flags_${isa}})
  endif()
endforeach()
message(STATUS "Instruction sets: ${OCTOMARCH_ISAS}")
