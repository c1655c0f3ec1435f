#include "octomarch/kernels/dispatch.hpp"

#include <cstdlib>
#include <string>
#include <vector>

#include "octomarch/base/error.hpp"

namespace octomarch::kernels {

#define OCTOMARCH_DECLARE_ISA(isa)           \
  namespace isa {                            \
  extern const KernelTable<float> kTable32;  \
  extern const KernelTable<double> kTable64; \
  }
OCTOMARCH_DECLARE_ISA(scalar)
OCTOMARCH_DECLARE_ISA(sse2)
OCTOMARCH_DECLARE_ISA(avx2)
OCTOMARCH_DECLARE_ISA(avx512)
OCTOMARCH_DECLARE_ISA(neon)
#undef OCTOMARCH_DECLARE_ISA

namespace {

std::vector<Isa> detect() {
  std::vector<Isa> isas;
#if defined(OCTOMARCH_HAVE_AVX2) || defined(OCTOMARCH_HAVE_AVX512)
  const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
                        __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("popcnt");
#endif
#ifdef OCTOMARCH_HAVE_AVX512
  if (has_avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl")) {
    isas.push_back({"avx512", &avx512::kTable32, &avx512::kTable64});
  }
#endif
#ifdef OCTOMARCH_HAVE_AVX2
  if (has_avx2) isas.push_back({"avx2", &avx2::kTable32, &avx2::kTable64});
#endif
#ifdef OCTOMARCH_HAVE_SSE2
  isas.push_back({"sse2", &sse2::kTable32, &sse2::kTable64});  // part of x86-64 itself
#endif
#ifdef OCTOMARCH_HAVE_NEON
  isas.push_back({"neon", &neon::kTable32, &neon::kTable64});  // part of AArch64 itself
#endif
  isas.push_back({"scalar", &scalar::kTable32, &scalar::kTable64});
  return isas;
}

std::string known_names() {
  std::string names;
  for (const Isa& isa : available_isas()) names += (names.empty() ? "" : ", ") + std::string(isa.name);
  return names;
}

}  // namespace

std::span<const Isa> available_isas() {
  static const std::vector<Isa> isas = detect();
  return isas;
}

const Isa& find_isa(std::string_view name) {
  std::string_view argument = "isa";
  if (name.empty()) {
    const char* pinned = std::getenv("OCTOMARCH_ISA");
    if (pinned == nullptr || *pinned == '\0') return available_isas().front();
    name = pinned;
    argument = "OCTOMARCH_ISA";
  }
  for (const Isa& isa : available_isas()) {
    if (isa.name == name) return isa;
  }
  require(false, argument, "one that this machine can run (" + known_names() + ")", "'" + std::string(name) + "'");
  return available_isas().back();
}

}  // namespace octomarch::kernels
