#include "outcrop/fracture/rock_statistics.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <map>

#include "outcrop/core/error.h"
#include "outcrop/core/json.h"
#include "outcrop/core/parallel.h"
#include "outcrop/fracture/rock_formulas.h"
#include "outcrop/fracture/trace_map.h"
#include "rock_cells.h"

namespace outcrop {
namespace {

constexpr double kLineSides = 8.0;                                                   // Length of a scan line, in sides.
constexpr double kJointsToMeet = 4000.0;                                             // By the scan lines of a set,
constexpr double kMostLines = 64.0;                                                  // which are no more than this,
constexpr double kLeastLines = 8.0;                                                  // and no fewer.
constexpr Vec3 kSpread{0.8191725133961645, 0.6710436067037893, 0.5497004779019703};  // Roberts 2018: R₃
constexpr double kTouching = 1e-6;   // Of the side: nearer crossings are one joint, met where two faces join.
constexpr double kSoundPiece = 0.1;  // Metres: RQD counts pieces from here on (Deere 1964).
constexpr int kCuts = 4;             // Plane cuts along each axis, for traces.
constexpr double kLeastCutAngle = radians(30.0);  // Between a cut and a set whose traces it shows.

/// The order of groups in a report: sets, random joints, joints without discs.
struct GroupOrder {
  bool operator()(int a, int b) const { return (a >= 0) != (b >= 0) ? a >= 0 : a >= 0 ? a < b : a > b; }
};

struct Group {
  double area = 0.0;            // Each joint once.
  std::vector<Vec3> normals;    // One a disc; one a face where there are none.
  std::vector<double> weights;  // Areas, where there are no discs.
  std::vector<FaceMeasure> faces;
};

std::string group_name(const Tile& tile, int set) {
  if (set >= 0) {
    const std::string& own = tile.sets[static_cast<std::size_t>(set)].name;
    return own.empty() ? "set " + std::to_string(set + 1) : own;
  }
  switch (set) {
    case kAddedJoint:
      return "added";
    case kColumnJoint:
      return "columns";
    case kTierJoint:
      return "tiers";
    default:
      return "random";
  }
}

// All joints along parallel lines. @param rate  Joints a metre that are looked for.
std::vector<std::vector<Crossing>> scan(const RockCells& rock, const Vec3& direction, double rate, const Task& task) {
  const double a_line = std::max(1.0, rate * (rock.repeats() ? kLineSides : 1.0) * rock.side());
  return parallel_map(
      static_cast<std::size_t>(
          std::clamp(kJointsToMeet / a_line, kLeastLines, rock.repeats() ? kMostLines : kLineSides * kMostLines)),
      [&](std::size_t i) {
        // Evenly spread starts: lines along a side of the tile meet the same joints in each of its copies.
        const Vec3 start = rock.side() * glm::fract(0.5 + static_cast<double>(i) * kSpread);
        return rock.crossings(start, direction, kLineSides * rock.side());
      },
      task);
}

// Spacings between the joints of a line for which `wanted` holds.
template <class Wanted>
std::vector<double> spacings(const std::vector<Crossing>& line, double side, Wanted&& wanted) {
  std::vector<double> result;
  double last = -1.0;
  for (const Crossing& crossing : line) {
    if (!wanted(crossing)) continue;
    if (last >= 0.0 && crossing.at - last > kTouching * side) result.push_back(crossing.at - last);
    last = crossing.at;
  }
  return result;
}

void measure_spacing(SetStatistics& set, const Tile& tile, const RockCells& rock, const Task& task) {
  double sum = 0.0;
  double squares = 0.0;
  for (const std::vector<Crossing>& line : scan(rock, set.orientation.mean, set.p32, task))
    for (const double s : spacings(line, rock.side(), [&](const Crossing& c) {
           return c.joint != kWall && set_of(tile, c.joint) == set.set;
         })) {
      sum += s;
      squares += s * s;
      ++set.spacings;
    }
  if (set.spacings == 0) return;
  const auto n = static_cast<double>(set.spacings);
  set.scanned_spacing = sum / n;
  set.spacing_cv = std::sqrt(std::max(0.0, squares / n - sum / n * sum / n)) / set.scanned_spacing;
}

// Traces on cuts across the three axes, as wide as the tile; those of a set on cuts that it crosses steeply.
void measure_traces(std::vector<SetStatistics>& sets, const Tile& tile, const RockCells& rock) {
  std::vector<std::vector<double>> lengths(sets.size());
  const double side = tile.side;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < kCuts; ++i) {
      CutPlane cut{.u = Vec3(0.0), .v = Vec3(0.0), .width = side, .height = side};
      cut.origin[axis] = (i + 0.5) / kCuts * side;
      cut.u[(axis + 1) % 3] = 1.0;
      cut.v[(axis + 2) % 3] = 1.0;
      for (const Trace& trace : trace_map(tile, rock, cut))
        for (std::size_t k = 0; k < sets.size(); ++k)
          if (sets[k].set == trace.set &&
              (trace.set < 0 || std::abs(sets[k].orientation.mean[axis]) < std::cos(kLeastCutAngle)))
            lengths[k].push_back(trace.length());
    }
  for (std::size_t k = 0; k < sets.size(); ++k) {
    std::vector<double>& own = lengths[k];
    if (own.empty()) continue;
    std::sort(own.begin(), own.end());
    sets[k].trace_median = own[own.size() / 2];
    for (const double length : own) sets[k].trace_mean += length / static_cast<double>(own.size());
  }
}

std::vector<SetStatistics> measure_sets(const Tile& tile, const RockCells& rock, const Task& task) {
  std::map<int, Group, GroupOrder> groups;
  for (std::size_t s = 0; s < tile.sets.size(); ++s) groups[static_cast<int>(s)];  // also those that bound nothing
  std::vector<bool> is_seen(tile.discs.size(), false);
  for (const RockCells::Cell& cell : rock.cells())
    for (const Polytope::Face& face : cell.shape.faces) {
      if (face.joint == kWall) continue;
      const FaceMeasure m = measure(cell.shape, face);
      Group& group = groups[set_of(tile, face.joint)];
      group.area += 0.5 * m.area;
      group.faces.push_back(m);
      if (face.joint < 0) {
        group.normals.push_back(m.normal);
        group.weights.push_back(m.area);
      } else if (!is_seen[static_cast<std::size_t>(face.joint)]) {
        is_seen[static_cast<std::size_t>(face.joint)] = true;
        group.normals.push_back(tile.discs[static_cast<std::size_t>(face.joint)].normal);
      }
    }
  std::vector<SetStatistics> result;
  for (const auto& [set, group] : groups) {
    SetStatistics s;
    s.set = set;
    s.name = group_name(tile, set);
    s.joints = group.weights.empty() ? group.normals.size() : 0;
    s.p32 = group.area / rock.volume();
    s.orientation = axis_statistics(group.normals, group.weights);
    if (set >= 0 || set == kTierJoint) {
      double met = 0.0;
      for (const FaceMeasure& face : group.faces)
        met += 0.5 * face.area * std::abs(glm::dot(face.normal, s.orientation.mean));
      if (met > 0.0) s.spacing = rock.volume() / met;
      measure_spacing(s, tile, rock, task);
    }
    result.push_back(std::move(s));
  }
  measure_traces(result, tile, rock);
  return result;
}

// The value below which a share of the total weight lies, interpolated between entries; sorted by value.
double quantile(const std::vector<std::pair<double, double>>& sorted, double share) {
  double total = 0.0;
  for (const auto& [value, weight] : sorted) total += weight;
  double before = 0.0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const double middle = before + 0.5 * sorted[i].second;  // an entry stands for the middle of its weight
    if (middle >= share * total) {
      if (i == 0) return sorted[0].first;
      const double previous = before - 0.5 * sorted[i - 1].second;
      const double t = (share * total - previous) / (middle - previous);
      return sorted[i - 1].first + t * (sorted[i].first - sorted[i - 1].first);
    }
    before += sorted[i].second;
  }
  return sorted.back().first;
}

Quantiles quantiles(std::vector<std::pair<double, double>> values) {
  std::sort(values.begin(), values.end());
  return {quantile(values, 0.1), quantile(values, 0.5), quantile(values, 0.9)};
}

void measure_blocks(RockStatistics& rock, const Tile& tile) {
  const auto n = static_cast<double>(tile.blocks.size());
  double squares = 0.0;
  double log_elongation = 0.0;
  double log_flatness = 0.0;
  std::vector<std::pair<double, double>> by_number;
  std::vector<std::pair<double, double>> by_volume;
  for (const Block& block : tile.blocks) {
    const BlockMeasure m{block.volume, principal_sizes(block.hull), static_cast<int>(block.planes.size())};
    rock.volume_mean += m.volume / n;
    squares += m.volume * m.volume / n;
    rock.faces_mean += m.faces / n;
    log_elongation += std::log(m.elongation()) / n;
    log_flatness += std::log(m.flatness()) / n;
    by_number.emplace_back(m.volume, 1.0);
    by_volume.emplace_back(m.volume, m.volume);
    rock.blocks.push_back(m);
  }
  rock.volume_cv = std::sqrt(std::max(0.0, squares - rock.volume_mean * rock.volume_mean)) / rock.volume_mean;
  rock.volume_by_number = quantiles(std::move(by_number));
  rock.volume_by_volume = quantiles(std::move(by_volume));
  rock.elongation = std::exp(log_elongation);
  rock.flatness = std::exp(log_flatness);
}

void measure_lines(RockStatistics& rock, const RockCells& cells, const Task& task) {
  for (const RockCells::Cell& cell : cells.cells())
    for (const Polytope::Face& face : cell.shape.faces) {
      if (face.joint == kWall) continue;
      const FaceMeasure m = measure(cell.shape, face);
      for (int axis = 0; axis < 3; ++axis)
        rock.joints_per_metre[static_cast<std::size_t>(axis)] +=
            0.5 * m.area * std::abs(m.normal[axis]) / cells.volume();
    }
  double sound = 0.0;
  double all = 0.0;
  for (const std::vector<Crossing>& line : scan(cells, {0, 0, 1}, rock.joints_per_metre[2], task))
    for (const double s : spacings(line, cells.side(), [](const Crossing& c) { return c.joint != kWall; })) {
      all += s;
      if (s >= kSoundPiece) sound += s;
    }
  rock.rqd_measured = all > 0.0 ? 100.0 * sound / all : 100.0;
  rock.rqd_priest_hudson = rqd_priest_hudson(rock.joints_per_metre[2]);
}

void write_quantiles(JsonWriter& json, std::string_view key, const Quantiles& q) {
  json.begin_object(key).value("d10", q.d10).value("d50", q.d50).value("d90", q.d90).end_object();
}

}  // namespace

RockStatistics measure_rock(const Tile& tile, const Task& task) {
  require(!tile.blocks.empty(), "tile", "at least one block", 0.0);
  const RockCells cells(tile);
  RockStatistics rock;
  rock.side = tile.side;
  rock.sets = measure_sets(tile, cells, task);
  measure_blocks(rock, tile);
  for (const SetStatistics& set : rock.sets) {
    rock.p32 += set.p32;
    rock.jv += set.spacing > 0.0 ? 1.0 / set.spacing : set.p32;
  }
  rock.beta = rock.volume_mean * rock.jv * rock.jv * rock.jv;
  rock.rqd_2005 = rqd_2005(rock.jv);
  rock.rqd_1982 = rqd_1982(rock.jv);
  measure_lines(rock, cells, task);
  rock.gap_share = std::max(0.0, 1.0 - tile.statistics.filled_share);
  rock.overlap_share = tile.statistics.overlap_share;
  return rock;
}

void write_rock_statistics(JsonWriter& json, const RockStatistics& rock) {
  json.begin_array("joint_sets");
  for (const SetStatistics& set : rock.sets) {
    json.begin_object().value("name", set.name).value("joints", static_cast<double>(set.joints));
    json.value("p32", set.p32);
    if (set.set >= 0) {
      const Orientation mean = orientation_of(set.orientation.mean);
      json.value("dip_deg", degrees(mean.dip)).value("dip_direction_deg", degrees(mean.dip_direction));
      json.value("kappa", set.orientation.kappa);
    }
    if (set.spacing > 0.0) json.value("spacing", set.spacing);
    if (set.spacings > 0) json.value("spacing_cv", set.spacing_cv);
    if (set.trace_mean > 0.0) json.value("trace_mean", set.trace_mean).value("trace_median", set.trace_median);
    json.end_object();
  }
  json.end_array();
  json.begin_object("block_volume").value("mean", rock.volume_mean).value("cv", rock.volume_cv);
  write_quantiles(json, "by_number", rock.volume_by_number);
  write_quantiles(json, "by_volume", rock.volume_by_volume);
  json.value("class", volume_class(rock.volume_mean)).end_object();
  json.value("faces", rock.faces_mean).value("elongation", rock.elongation).value("flatness", rock.flatness);
  json.value("p32", rock.p32).value("jv", rock.jv).value("jv_class", jv_class(rock.jv));
  json.value("beta", rock.beta).value("shape_class", shape_class(rock.beta));
  json.begin_array("joints_per_metre");
  for (const double rate : rock.joints_per_metre) json.item(rate);
  json.end_array();
  json.begin_object("rqd").value("palmstrom_2005", rock.rqd_2005).value("palmstrom_1982", rock.rqd_1982);
  json.value("priest_hudson", rock.rqd_priest_hudson).value("measured", rock.rqd_measured).end_object();
  json.value("gap_share", rock.gap_share).value("overlap_share", rock.overlap_share);
}

}  // namespace outcrop
