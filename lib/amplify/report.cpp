#include "outcrop/amplify/report.h"

#include <sys/resource.h>

#include <algorithm>
#include <numeric>

#include "outcrop/core/json.h"

namespace outcrop {
namespace {

void write_vector(JsonWriter& json, std::string_view key, std::initializer_list<double> values) {
  json.begin_array(key);
  for (const double v : values) json.item(v);
  json.end_array();
}

void write_count(JsonWriter& json, std::string_view key, std::size_t value) {
  json.value(key, static_cast<double>(value));
}

/// Least, median, mean, greatest and sum: what a distribution of blocks is judged by.
void write_summary(JsonWriter& json, std::string_view key, std::vector<double> values) {
  json.begin_object(key);
  if (!values.empty()) {
    std::sort(values.begin(), values.end());
    const double sum = std::accumulate(values.begin(), values.end(), 0.0);
    json.value("least", values.front()).value("median", values[values.size() / 2]);
    json.value("mean", sum / static_cast<double>(values.size())).value("greatest", values.back()).value("sum", sum);
  }
  json.end_object();
}

void write_input(JsonWriter& json, const AmplifyReport& report) {
  json.begin_object("input").value("heightmap", report.heightmap.string());
  json.value("strata", report.strata.empty() ? "built-in defaults" : report.strata.string());
  if (report.heightfield) {
    const ElevationGrid& grid = report.heightfield->grid();
    const auto [least, greatest] = std::minmax_element(grid.elevations.begin(), grid.elevations.end());
    write_vector(json, "samples", {double(grid.width), double(grid.height)});
    write_vector(json, "cell_size", {grid.cell_x, grid.cell_y});
    write_vector(json, "elevations", {*least, *greatest});
    json.boolean("georeferenced", grid.georeferenced).boolean("holes", report.heightfield->has_holes());
  }
  json.begin_array("notes");
  for (const std::string& note : report.notes) json.item(note);
  json.end_array().end_object();
}

void write_options(JsonWriter& json, const AmplifyReport& report) {
  const AmplifyOptions& options = report.options;
  json.begin_object("options").value("seed", std::to_string(options.seed)).value("resolution", options.resolution);
  write_vector(json, "region", {options.region_lo.x, options.region_lo.y, options.region_hi.x, options.region_hi.y});
  json.value("interpolation", report.interpolation == Interpolation::Smooth ? "smooth" : "bilinear");
  json.value("nodata", report.rock.nodata == NodataPolicy::Hole ? "hole" : "fill");
  json.boolean("solid", report.solid).value("threads", report.threads);
  write_count(json, "memory_limit", report.memory_limit);
  json.end_object();
  write_vector(json, "origin", {report.origin.x, report.origin.y, report.origin.z});
}

void write_planes(JsonWriter& json, std::string_view key, double filled_share, double mean, std::size_t most) {
  json.begin_object(key).value("filled_share", filled_share).value("mean_planes", mean);
  write_count(json, "most_planes", most);
  json.end_object();
}

void write_rock(JsonWriter& json, const RockReport& rock) {
  const TileStatistics& tile = rock.tile;
  json.begin_object().value("material", rock.material).value("block_type", name(rock.type));
  write_count(json, "samples", tile.samples);
  write_count(json, "discs", tile.discs);
  write_count(json, "clusters", tile.clusters);
  write_count(json, "merged_chips", tile.merged_chips);
  write_count(json, "tile_blocks", rock.tile_blocks);
  write_count(json, "replicated_blocks", rock.replicated_blocks);
  write_count(json, "finer_blocks", rock.finer_blocks);
  write_count(json, "bytes", rock.bytes);
  json.value("seconds", tile.seconds).value("overlap_share", tile.overlap_share);
  write_planes(json, "snapped", tile.filled_share, tile.mean_planes, tile.max_planes);
  json.begin_array("joint_sets");
  for (const SetIntensity& set : tile.intensities) {
    json.begin_object().value("name", set.name);
    if (set.asked > 0.0) json.value("asked_p32", set.asked);
    json.value("drawn_p32", set.drawn).value("made_p32", set.made).end_object();
  }
  json.end_array();
  write_planes(json, "plain_hulls", tile.plain_filled_share, tile.plain_mean_planes, tile.plain_max_planes);
  if (rock.measured) {
    json.begin_object("measured");
    write_tile_report(json, *rock.measured);
    json.end_object();
  }
  write_summary(json, "volume", rock.block_volumes);
  write_summary(json, "faces", {rock.block_faces.begin(), rock.block_faces.end()});
  std::vector<double> longest, shortest;
  for (const Vec3& size : rock.block_sizes) {
    longest.push_back(std::max({size.x, size.y, size.z}));
    shortest.push_back(std::min({size.x, size.y, size.z}));
  }
  write_summary(json, "longest_extent", longest);
  write_summary(json, "shortest_extent", shortest);
  json.begin_array("blocks");
  for (std::size_t i = 0; i < rock.block_volumes.size(); ++i) {
    json.begin_object().value("volume", rock.block_volumes[i]);
    if (i < rock.block_faces.size()) write_count(json, "faces", rock.block_faces[i]);
    if (i < rock.block_sizes.size()) {
      const Vec3& size = rock.block_sizes[i];
      write_vector(json, "size", {size.x, size.y, size.z});
    }
    json.end_object();
  }
  json.end_array().end_object();
}

void write_mesh_report(JsonWriter& json, const AmplifyReport& report) {
  if (!report.polygonized && !report.mesh) return;
  json.begin_object("mesh");
  if (const auto& mesh = report.mesh) {
    write_count(json, "vertices", mesh->vertices());
    write_count(json, "triangles", mesh->triangles());
    json.boolean("closed", mesh->closed());
    json.value("area", mesh->area());
    if (mesh->closed()) json.value("volume", mesh->volume());
  }
  if (const auto& made = report.polygonized) {
    json.value("resolution", made->resolution).value("tolerance", made->tolerance);
    write_count(json, "cells", made->cells);
    write_count(json, "evaluations", made->evaluations);
    write_count(json, "floating_parts_removed", made->parts_removed);
    write_count(json, "voids_removed", made->voids_removed);
  }
  json.end_object();
}

void write_seconds(JsonWriter& json, const StageSeconds& seconds) {
  json.begin_object("seconds").value("reading", seconds.reading).value("tiles", seconds.tiles);
  json.value("placement", seconds.placement).value("meshing", seconds.meshing).value("writing", seconds.writing);
  json.value("preview", seconds.preview).value("total", seconds.total).end_object();
}

}  // namespace

std::string_view version() noexcept { return OUTCROP_VERSION; }

std::size_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;  // Linux counts kibibytes.
}

std::string report_json(const AmplifyReport& report) {
  const Amplified& amplified = report.amplified;
  JsonWriter json;
  json.begin_object().value("program", "amplify").value("version", version()).value("command", report.command);
  write_input(json, report);
  write_options(json, report);
  std::size_t blocks = 0;
  json.begin_array("rocks");
  for (const RockReport& rock : amplified.rocks) {
    write_rock(json, rock);
    blocks += rock.replicated_blocks;
  }
  json.end_array();
  write_count(json, "replicated_blocks", blocks);
  json.value("rock_coverage", amplified.rock_coverage).value("mean_offset", amplified.mean_offset);
  json.value("mean_block_size", amplified.mean_block_size);
  write_mesh_report(json, report);
  if (const auto& preview = report.preview) {
    json.begin_object("preview");
    write_count(json, "leaves", preview->leaves);
    write_count(json, "rays", preview->rays);
    write_count(json, "steps", preview->steps);
    write_count(json, "capped_rays", preview->capped_rays);
    json.end_object();
  }
  write_seconds(json, report.seconds);
  write_count(json, "peak_memory", peak_memory());
  json.begin_array("outputs");
  for (const std::filesystem::path& path : report.outputs) json.item(path.string());
  return json.end_array().end_object().text();
}

}  // namespace outcrop
