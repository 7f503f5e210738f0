#include "outcrop/fracture/target.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "outcrop/core/error.h"
#include "outcrop/fracture/rock_formulas.h"
#include "outcrop/fracture/rock_statistics.h"
#include "tile_figure_svg.h"

namespace outcrop {
namespace {

constexpr double kLeastSide = 0.1;  // Metres: as strata files allow.
constexpr double kMostSide = 1000.0;
constexpr double kVolumeSlack = 0.15;
constexpr double kJvSlack = 0.10;

double jv_of_rqd(double rqd) { return (110.0 - rqd) / 2.5; }  // Palmström 2005, turned around

void check(const RockTarget& target) {
  require(target.any(), "target", "a block volume, Jv or RQD", "none");
  const auto positive = [](const std::optional<double>& v, std::string_view name) {
    if (v) require(std::isfinite(*v) && *v > 0.0, name, "> 0 and finite", *v);
  };
  positive(target.block_volume, "block_volume");
  positive(target.jv, "jv");
  if (target.rqd) require(*target.rqd >= 0.0 && *target.rqd <= 100.0, "rqd", "in [0, 100]", *target.rqd);
}

std::string listed(double volume, double jv, double rqd) {
  return "block_volume " + short_number(volume) + " m³, jv " + short_number(jv) + " 1/m, rqd " + short_number(rqd) +
         " %";
}

}  // namespace

std::string described(const RockTarget& target) {
  std::string text;
  const auto add = [&](const std::optional<double>& v, const char* name, const char* unit) {
    if (v) text += (text.empty() ? "" : ", ") + std::string(name) + " " + short_number(*v) + unit;
  };
  add(target.block_volume, "block_volume", " m³");
  add(target.jv, "jv", " 1/m");
  add(target.rqd, "rqd", " %");
  return text;
}

TileOptions scaled(TileOptions options, double factor) {
  require(std::isfinite(factor) && factor > 0.0, "factor", "> 0 and finite", factor);
  options.side *= factor;
  options.spacing *= factor;
  options.aperture *= factor;
  options.rounding *= factor;
  options.pattern = scaled(std::move(options.pattern), factor);
  return options;
}

TargetedTile fit_tile(const TileOptions& options, const RockTarget& target, Seed seed, const Task& task) {
  check(target);
  TileOptions measured = options;
  measured.blocks.clear();
  const RockStatistics rock = measure_rock(make_tile(measured, seed, task), task);

  // Every target is a wish for the logarithm of the scale; their mean has the least squared error. A block volume grows
  // with the cube of the scale, Jv falls with it.
  double sum = 0.0;
  int wishes = 0;
  const auto wish = [&](double log_scale) {
    sum += log_scale;
    ++wishes;
  };
  if (target.block_volume) wish(std::log(*target.block_volume / rock.volume_mean) / 3.0);
  if (target.jv) wish(std::log(rock.jv / *target.jv));
  if (target.rqd) wish(std::log(rock.jv / jv_of_rqd(*target.rqd)));
  TargetedTile result;
  result.scale = std::clamp(std::exp(sum / wishes), kLeastSide / options.side, kMostSide / options.side);
  result.options = scaled(options, result.scale);
  result.block_volume = rock.volume_mean * result.scale * result.scale * result.scale;
  result.jv = rock.jv / result.scale;
  result.rqd = rqd_2005(result.jv);

  const auto misses = [](double reached, double wanted, double slack) {
    return std::abs(reached / wanted - 1.0) > slack;
  };
  if (target.block_volume && misses(result.block_volume, *target.block_volume, kVolumeSlack)) result.is_met = false;
  if (target.jv && misses(result.jv, *target.jv, kJvSlack)) result.is_met = false;
  if (target.rqd && misses(result.jv, jv_of_rqd(*target.rqd), kJvSlack)) result.is_met = false;
  result.note = described(target) + " asked for: tile_side " + short_number(result.options.side) + ", which makes " +
                listed(result.block_volume, result.jv, result.rqd);
  if (!result.is_met && wishes > 1)
    result.note +=
        "; blocks of this shape (β " + short_number(rock.beta) + ") cannot have all of it, this is the nearest";
  else if (!result.is_met)
    result.note += "; tiles are 0.1 to 1000 m wide, this is the nearest";
  return result;
}

}  // namespace outcrop
