/// Counter-based random streams: the same numbers for the same (seed, purpose, index), on any thread.
#pragma once

#include <cstdint>
#include <string_view>

#include "outcrop/core/vec.h"

namespace outcrop {

using Seed = std::uint64_t;

/// One independent stream of random numbers.
///
/// Streams are named, not shared: `Rng(seed, "discs", i)` is the stream of disc i, whatever was drawn elsewhere.
/// Draw one number per statement, since C++ leaves the order of arguments open.
/// Method: SplitMix64's finaliser over a Weyl sequence @cite steele_2014.
class Rng {
 public:
  constexpr Rng(Seed seed, std::string_view purpose, std::uint64_t index = 0) noexcept
      : state_(mix(mix(seed + kWeyl) ^ mix(hash(purpose)) ^ mix(index * kOdd + 1))) {}

  /// 64 random bits.
  constexpr std::uint64_t next() noexcept { return mix(state_ += kWeyl); }
  /// Uniform in [0, 1), 53 bits.
  constexpr double uniform() noexcept { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  /// Uniform in [lo, hi).
  constexpr double uniform(double lo, double hi) noexcept { return lo + (hi - lo) * uniform(); }
  /// Uniform in {0, …, n − 1}, n > 0; bias below n · 2⁻⁶⁴.
  constexpr std::uint64_t below(std::uint64_t n) noexcept {
    return static_cast<std::uint64_t>((static_cast<Wide>(next()) * n) >> 64);
  }
  /// Uniform on the unit sphere.
  Vec3 direction() noexcept;

 private:
  __extension__ using Wide = unsigned __int128;

  static constexpr std::uint64_t kWeyl = 0x9E3779B97F4A7C15ull;
  static constexpr std::uint64_t kOdd = 0xD1342543DE82EF95ull;
  static constexpr std::uint64_t mix(std::uint64_t z) noexcept {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }
  static constexpr std::uint64_t hash(std::string_view text) noexcept {
    std::uint64_t h = 0xCBF29CE484222325ull;  // FNV-1a
    for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001B3ull;
    return h;
  }

  std::uint64_t state_;
};

}  // namespace outcrop
