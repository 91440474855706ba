// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_SEEDED_RANDOM_H_
#define RSSTAB_IGF_BASE_SEEDED_RANDOM_H_

#include <cmath>
#include <cstdint>
#include <numbers>

namespace rsstab {

// Mixes 64 bits so that neighbouring inputs give unrelated outputs (the finaliser of SplitMix64,
// Steele et al. 2014). Counter-based: per-pixel numbers do not depend on the order of the pixels.
[[nodiscard]] constexpr std::uint64_t MixBits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

// A stream of numbers that is the same on every platform (the standard distributions are not).
class SeededRandom {
 public:
  // Streams with different `stream` are unrelated, so that adding numbers to one changes no other.
  explicit SeededRandom(std::uint64_t seed, std::uint64_t stream = 0)
      : state_(MixBits(seed) ^ MixBits(~stream)) {}

  [[nodiscard]] std::uint64_t Bits() { return MixBits(state_++); }

  // In [0, 1).
  [[nodiscard]] double Uniform() { return static_cast<double>(Bits() >> 11) * 0x1.0p-53; }
  // In [low, high).
  [[nodiscard]] double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  // In [low, high], both included; high >= low.
  [[nodiscard]] int Integer(int low, int high) {
    return low + static_cast<int>(Uniform() * (high - low + 1.0));
  }
  // Mean 0, standard deviation 1 (Box-Muller).
  [[nodiscard]] double Normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * Uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_SEEDED_RANDOM_H_
