#include "joint_laws.h"

#include <algorithm>
#include <cmath>

namespace outcrop {
namespace {

constexpr int kRadiusAttempts = 64;  // For a lognormal radius within its bounds; then the nearest bound.
constexpr int kRunIn = 32;           // Gaps before a sequence counts: its phase has forgotten where it began.

double normal_deviate(Rng& rng) {
  const double u = 1.0 - rng.uniform();
  const double turn = 2.0 * kPi * rng.uniform();
  return std::sqrt(-2.0 * std::log(u)) * std::cos(turn);
}

// A lognormal number with the given mean and coefficient of variation.
double lognormal(double mean, double cv, Rng& rng) {
  const double variance = std::log(1.0 + cv * cv);  // of the logarithm
  return mean * std::exp(std::sqrt(variance) * normal_deviate(rng) - 0.5 * variance);
}

}  // namespace

Vec3 draw_normal(const JointSet& set, Rng& rng) {
  if (set.measured.empty()) return fisher_direction(set.normal, set.kappa, rng);
  return set.measured[rng.below(set.measured.size())];
}

double draw_radius(const JointSet& set, Rng& rng) {
  const double lo = set.radius_lo;
  const double hi = set.radius_hi;
  if (set.radius_law == RadiusLaw::Lognormal) {
    double r = 0.0;
    for (int attempt = 0; attempt < kRadiusAttempts; ++attempt) {
      r = lognormal(set.radius_mean, set.radius_cv, rng);
      if (r >= lo && r <= hi) return r;
    }
    return std::clamp(r, lo, hi);
  }
  const double u = rng.uniform();
  if (set.radius_law == RadiusLaw::Uniform || lo == hi) return lo + u * (hi - lo);
  const double a = set.radius_exponent;
  return lo * std::pow(1.0 - u * (1.0 - std::pow(lo / hi, a)), -1.0 / a);
}

double mean_gap(const JointSet& set) noexcept { return set.spacing > 0.0 ? set.spacing : 1.0 / set.p32; }

namespace {

double gap_by_law(const JointSet& set, double mean, Rng& rng) {
  if (set.spacing > 0.0 && set.spacing_law == SpacingLaw::Fixed) return mean;
  if (set.spacing > 0.0 && set.spacing_law == SpacingLaw::Lognormal) return lognormal(mean, set.spacing_cv, rng);
  return -mean * std::log(1.0 - rng.uniform());  // by P32: planes at random
}

double draw_gap(const JointSet& set, const GapRule& rule, Rng& rng) {
  const double mean = mean_gap(set);
  const double least = std::min(rule.least, mean);
  return mean > least ? least + gap_by_law(set, mean - least, rng) : mean;
}

}  // namespace

std::vector<double> closed_positions(const JointSet& set, double period, const GapRule& rule, bool from_zero,
                                     Rng& rng) {
  const double rounding = rule.periods == GapRule::Periods::One ? 0.5 : rng.uniform();
  const auto count = static_cast<std::size_t>(std::max(1.0, std::floor(period / mean_gap(set) + rounding)));
  std::vector<double> gaps(count);
  double sum = 0.0;
  for (double& gap : gaps) sum += gap = draw_gap(set, rule, rng);
  std::vector<double> positions(count);
  double at = from_zero ? 0.0 : period * rng.uniform();
  for (std::size_t i = 0; i < count; ++i) {
    positions[i] = at < period ? at : at - period;
    at = positions[i] + gaps[i] * (period / sum);
  }
  std::sort(positions.begin(), positions.end());
  return positions;
}

std::vector<double> open_positions(const JointSet& set, double reach, const GapRule& rule, Rng& rng) {
  double at = -reach - mean_gap(set) * (kRunIn + rng.uniform());
  std::vector<double> positions;
  while (at < reach) {
    if (at >= -reach) positions.push_back(at);
    at += draw_gap(set, rule, rng);
  }
  return positions;
}

}  // namespace outcrop
