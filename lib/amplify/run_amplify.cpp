#include "outcrop/amplify/run_amplify.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <utility>

#include "clip_mesh.h"
#include "outcrop/amplify/report.h"
#include "outcrop/amplify/tile_reports.h"
#include "outcrop/core/file.h"
#include "outcrop/core/parallel.h"
#include "outcrop/mesh/mesh_measure.h"
#include "outcrop/mesh/write_mesh.h"
#include "outcrop/render/camera.h"
#include "outputs.h"

namespace outcrop {
namespace {

constexpr double kFocusBlocks = 18.0;         // Across the part that the default camera frames: each block is seen.
constexpr double kFocusHeight = 0.8;          // Of the focus's width.
constexpr double kCameraTurn = radians(25);   // Off the fall line: walls seen at an angle show their depth.
constexpr double kCameraRise = 0.35;          // Height over distance of the default camera.
constexpr int kFocusSamples = 192;            // Across the region, to find its steepest part.
constexpr double kTolerance = 0.1;            // Of the resolution: below what shading shows.
constexpr double kSteepShare = 0.5;           // Of a region; above it coarse cells save less than the search for them costs.
constexpr double kLeastBytesACell = 60.0;     // Two triangles and their share of vertices: below what meshing takes.
constexpr double kMemoryShare = 0.5;          // Of the limit: larger meshes wait on disk while they are made.
constexpr std::size_t kBytesASquare = 4 << 20; // Of 64² cells while they are meshed, twice what was measured on rock.
constexpr double kMostTriangles = 8e9;        // Vertices are numbered by 32 bits.

// What one core does, measured on the canyon of the demo; for --dry-run only.
constexpr double kTrianglesASecond = 400e3;
constexpr double kPreviewPixelsASecond = 10e3;
constexpr double kLevelSetCellsASecond = 100e3;  // 77 to 118 thousand at 0.15 to 0.4 m; cells of the closed surface.

/// A sensible line for files: what was made from what, without paths or thread counts, so that runs compare to the byte.
std::vector<std::string> comments(const AmplifyReport& report) {
  const AmplifyOptions& options = report.options;
  const Vec3& origin = report.origin;
  return {"outcrop " + std::string(version()) + " amplify " + report.heightmap.filename().string(),
          "strata " + (report.strata.empty() ? "default" : report.strata.filename().string()),
          "seed " + std::to_string(options.seed) + ", resolution " + number_text(options.resolution, 9) + " m",
          "origin " + number_text(origin.x, 15) + " " + number_text(origin.y, 15) + " " + number_text(origin.z, 15)};
}

/// The terrain's south-west sample at sea level; along axes on which floats are too coarse for the region's cells there,
/// the last whole metre before the region.
Vec3 mesh_origin(const Heightfield& heightfield, const Box& region, double resolution) {
  Vec3 origin(heightfield.lo(), 0.0);
  for (int axis = 0; axis < 3; ++axis)
    if (std::max(region.hi[axis] - origin[axis], origin[axis] - region.lo[axis]) > kExactCells * resolution)
      origin[axis] = std::floor(region.lo[axis]);
  return origin;
}

Heightfield make_heightfield(const AmplifyRun& run, HeightfieldFile file) {
  try {
    return Heightfield(std::move(file.grid), run.interpolation);
  } catch (const ParameterError& error) {
    throw InputError(run.heightmap.string() + ": " + error.what());
  }
}

/// The region's own heights as a heightfield, so that its steepest part is sought inside it.
Heightfield resampled(const Heightfield& heightfield, const Vec2& lo, const Vec2& hi) {
  ElevationGrid grid;
  const Vec2 extent = hi - lo;
  const double cell = std::max(extent.x, extent.y) / (kFocusSamples - 1);
  grid.width = std::max(2, static_cast<int>(std::floor(extent.x / cell + 1e-6)) + 1);
  grid.height = std::max(2, static_cast<int>(std::floor(extent.y / cell + 1e-6)) + 1);
  grid.cell_x = extent.x / (grid.width - 1);
  grid.cell_y = extent.y / (grid.height - 1);
  grid.origin = lo;
  grid.elevations.reserve(static_cast<std::size_t>(grid.width) * grid.height);
  bool any = false;
  for (int row = 0; row < grid.height; ++row)
    for (int column = 0; column < grid.width; ++column) {
      const Vec2 p = lo + Vec2(column * grid.cell_x, (grid.height - 1 - row) * grid.cell_y);
      const bool missing = heightfield.has_holes() && heightfield.hole_distance(p.x, p.y) > 0.0;
      any = any || !missing;
      grid.elevations.push_back(missing ? std::numeric_limits<float>::quiet_NaN()
                                        : static_cast<float>(heightfield.at(p.x, p.y).h));
    }
  return any ? Heightfield(std::move(grid)) : heightfield;
}

/// The share of a rectangle where the ground is steeper than `slope`.
double steep_share(const Heightfield& heightfield, const Vec2& lo, const Vec2& hi, double slope) {
  int steep = 0;
  for (int j = 0; j < kFocusSamples; ++j)
    for (int i = 0; i < kFocusSamples; ++i) {
      const Vec2 p = lo + (hi - lo) * (Vec2(i, j) + 0.5) / double(kFocusSamples);
      const Heightfield::Sample s = heightfield.at(p.x, p.y);
      steep += std::hypot(s.hx, s.hy) >= std::tan(slope);
    }
  return double(steep) / (kFocusSamples * kFocusSamples);
}

/// Lengths of materials whose tile the terrain decides: only now can they be held against it.
void check_lengths(const Json& strata, const std::filesystem::path& folder, double side) {
  try {
    (void)read_strata(strata, folder, side);
  } catch (const InputError& error) {
    throw InputError(std::string(error.what()) + "; the terrain makes tile_side " + number_text(side));
  }
}

PreviewOptions preview_options(const AmplifyRun& run, const AmplifyReport& report) {
  const Amplified& amplified = report.amplified;
  PreviewOptions options;
  options.width = run.width;
  options.height = run.height;
  options.region = amplified.region;
  options.detail = report.options.resolution;
  options.colours = amplified.label_colours;
  options.seed = run.seed;
  const double fov = radians(run.fov_deg);
  if (run.camera) {
    const std::array<double, 6>& c = *run.camera;
    const Vec3 corner(report.heightfield->lo(), 0.0);
    options.camera = {corner + Vec3(c[0], c[1], c[2]), corner + Vec3(c[3], c[4], c[5]), fov};
  } else {
    const Vec2 lo = report.options.region_lo, hi = report.options.region_hi;
    const double size = std::min({kFocusBlocks * amplified.mean_block_size, hi.x - lo.x, hi.y - lo.y});
    const SteepWindow steep = steepest_window(resampled(*report.heightfield, lo, hi), size, report.rock.placement.slope);
    const double c = std::cos(kCameraTurn), s = std::sin(kCameraTurn);
    const Vec2 d = steep.downhill;
    const Vec3 from(c * d.x - s * d.y, s * d.x + c * d.y, kCameraRise);
    const Vec3 half(0.5 * size, 0.5 * size, 0.5 * kFocusHeight * size);
    options.camera = framed(*amplified.field, {steep.focus - half, steep.focus + half}, from, fov,
                            double(run.width) / run.height, amplified.region);
  }
  // The sun stands high to the left behind the camera: light rakes over the rock and reaches into valleys.
  const CameraAxes axes = camera_axes(options.camera);
  const Vec3 ahead = glm::cross(Vec3(0, 0, 1), axes.right);
  options.sun = glm::normalize(-0.6 * axes.right - 0.5 * ahead + Vec3(0, 0, 0.85));
  return options;
}

std::size_t block_count(const Amplified& amplified) {
  std::size_t blocks = 0;
  for (const RockReport& rock : amplified.rocks) blocks += rock.replicated_blocks;
  return blocks;
}

/// What a run has to mesh.
struct Expectation {
  PolygonizeEstimate mesh;
  std::size_t meshings = 0;      ///< Twice where a sheet is cut and a level set needs the solid.
  double level_set_cells = 0.0;  ///< Of the closed surface, walls and floor included; 0 without a level set.
};

/// Bytes that a mesh file takes; a closed surface has half as many vertices as triangles.
double file_bytes(const std::filesystem::path& path, const Expectation& expected) {
  const auto triangles = static_cast<double>(expected.mesh.triangles);
  const std::string extension = path.extension().string();
  if (extension == ".stl") return 84.0 + 50.0 * triangles;
  if (extension == ".obj") return 75.0 * triangles;
  if (extension == ".vdb") return 12.0 * expected.level_set_cells;
  return 27.0 * triangles;  // PLY: 13 a face, 28 a vertex.
}

std::string dry_run_text(const AmplifyRun& run, const AmplifyReport& report, const Expectation& expected) {
  const Amplified& amplified = report.amplified;
  const AmplifyOptions& options = report.options;
  const double triangles = static_cast<double>(expected.mesh.triangles);
  const double mesh_seconds = static_cast<double>(expected.meshings) * triangles / kTrianglesASecond +
                              expected.level_set_cells / kLevelSetCellsASecond;
  const double bytes = static_cast<double>(peak_memory() + expected.mesh.bytes) +
                       kLevelSetBytesACell * expected.level_set_cells;
  const double pixels = run.previews.empty() ? 0.0 : double(run.width) * run.height;
  const double seconds = (mesh_seconds + pixels / kPreviewPixelsASecond) / report.threads + report.seconds.reading +
                         amplified.tile_seconds + amplified.placement_seconds;
  const Vec2 extent = options.region_hi - options.region_lo;
  std::string text = "region     " + number_text(extent.x) + " m x " + number_text(extent.y) + " m at " +
                     number_text(options.resolution) + " m\n";
  text += "blocks     " + count_text(double(block_count(amplified))) + "\n";
  text += "cells      " + count_text(double(expected.mesh.cells)) + "\n";
  text += "triangles  " + count_text(triangles) + "\n";
  text += "seconds    " + number_text(std::ceil(seconds), 6) + " on " + std::to_string(report.threads) + " threads\n";
  text += "memory     " + byte_text(bytes) + ", limit of the mesh " + byte_text(double(report.memory_limit)) + "\n";
  for (const auto& path : run.meshes) text += path.string() + "  " + byte_text(file_bytes(path, expected)) + "\n";
  for (const auto& path : run.previews)
    text += path.string() + "  " + byte_text(pixels * (path.extension() == ".png" ? 1.8 : 28.0)) + "\n";
  return text;
}

/// Writers of the triangle meshes of a run, and a measure that watches.
class Writers {
 public:
  Writers(const std::vector<std::filesystem::path>& paths, const MeshMetadata& metadata, const Task& task) {
    for (const auto& path : paths)
      if (!is_vdb(path)) files_.push_back(mesh_writer(path, metadata, task));
    for (const auto& file : files_) sinks_.push_back(file.get());
    sinks_.push_back(&measure_);
  }
  Writers(const Writers&) = delete;
  Writers& operator=(const Writers&) = delete;

  [[nodiscard]] bool any() const { return !files_.empty(); }
  [[nodiscard]] std::span<MeshSink* const> sinks() const { return sinks_; }
  [[nodiscard]] const MeshMeasure& measure() const { return measure_; }

 private:
  MeshMeasure measure_;
  std::vector<std::unique_ptr<MeshSink>> files_;
  std::vector<MeshSink*> sinks_;
};

/// One run, stage by stage.
class Runner {
 public:
  Runner(AmplifyRun run, const Notify& notify, const Task& task) : run_(std::move(run)), notify_(notify), task_(task) {}

  std::string operator()() {
    prepare();
    if (run_.heightmap.empty()) {
      report_tiles_alone();
      return {};
    }
    read();
    compose();
    if (run_.dry_run) return dry_run_text(run_, report_, expected_);
    if (!run_.meshes.empty()) mesh();
    if (!run_.previews.empty()) preview();
    if (!run_.tile_reports.empty()) report_tiles(default_tile_side(*report_.heightfield));
    if (!run_.report.empty()) write_report();
    return {};
  }

 private:
  [[nodiscard]] const Amplified& amplified() const { return report_.amplified; }

  /// Lines wait until the inputs have been found usable: a refusal is one line and stands alone.
  void say(const std::string& line) {
    waiting_.push_back(line);
    if (accepted_) speak();
  }
  void speak() {
    accepted_ = true;
    for (const std::string& line : waiting_)
      if (notify_) notify_(line);
    waiting_.clear();
  }
  void note(const std::string& line) {
    report_.notes.push_back(line);
    say(line);
  }

  /// Everything that can be refused before any work.
  void prepare() {
    const bool has_terrain_output = !run_.meshes.empty() || !run_.previews.empty() || !run_.report.empty();
    require(!run_.heightmap.empty() || (!run_.tile_reports.empty() && !has_terrain_output && !run_.dry_run), "HEIGHTMAP",
            "a file, or --tile-report as the only output", "none");
    if (!run_.dry_run && !has_terrain_output && run_.tile_reports.empty()) {
      const std::string stem = run_.heightmap.stem().string() + "_rock";
      run_.meshes = {stem + ".ply"};
      run_.previews = {stem + ".png"};
      say("writing " + stem + ".ply and " + stem + ".png; -o, --preview or --report choose otherwise");
    }
    check_size(run_.width, run_.height);
    require(run_.fov_deg >= 1.0 && run_.fov_deg <= 150.0, "--fov-deg", "1 to 150 degrees", run_.fov_deg);
    if (run_.camera) {
      const std::array<double, 6>& c = *run_.camera;
      require(c[0] != c[3] || c[1] != c[4] || c[2] != c[5], "--camera", "a target other than the position",
              "the same twice");
    }
    report_.memory_limit = memory_limit_bytes(run_.memory_limit_gib);
    check_outputs({run_.meshes, run_.previews, run_.report, run_.tile_reports}, {run_.heightmap, run_.strata});
    report_.command = run_.command;
    report_.heightmap = run_.heightmap;
    report_.strata = run_.strata;
    report_.interpolation = run_.interpolation;
    report_.solid = run_.solid;
    report_.threads = thread_count();
  }

  void read() {
    task_.begin("reading");
    const std::filesystem::path folder = run_.strata.parent_path();
    const std::optional<Json> strata = run_.strata.empty() ? std::nullopt : std::optional(read_json(run_.strata));
    if (strata) report_.rock = read_strata(*strata, folder);
    if (run_.nodata) report_.rock.nodata = *run_.nodata;
    HeightfieldFile file = read_heightfield(run_.heightmap, run_.heights);
    for (const std::string& line : file.notes) note(run_.heightmap.string() + ": " + line);
    report_.heightfield = make_heightfield(run_, std::move(file));
    const double side = default_tile_side(*report_.heightfield);
    if (strata) check_lengths(*strata, folder, side);
    meet_rock_targets(side);
    report_.seconds.reading = watch_.lap();
    task_.check();
  }

  void meet_rock_targets(double default_side) {
    SizedStrata sized = meet_targets(std::move(report_.rock), default_side, run_.seed, task_);
    report_.rock = std::move(sized.file);
    for (const std::string& line : sized.notes) note(line);
  }

  void report_tiles(double default_side) {
    const std::string title = run_.strata.empty() ? "Rock" : run_.strata.stem().string();
    write_tile_reports(run_.tile_reports, report_.rock, default_side, run_.seed, title, task_);
    for (const auto& path : run_.tile_reports) written(path, "materials in numbers");
  }

  /// Without a terrain: tiles are as wide as the paper's where a material does not say.
  void report_tiles_alone() {
    if (!run_.strata.empty()) report_.rock = read_strata(read_json(run_.strata), run_.strata.parent_path(), kPatternSide);
    meet_rock_targets(kPatternSide);
    speak();
    report_tiles(kPatternSide);
  }

  void compose() {
    const Window window = choose_window(*report_.heightfield, report_.rock, run_);
    if (!window.note.empty()) note(window.note);
    report_.options = {window.lo, window.hi, window.resolution, run_.seed, !run_.report.empty()};
    tolerance_ = run_.tolerance.value_or(0.0);
    if (!run_.tolerance &&
        steep_share(*report_.heightfield, window.lo, window.hi, report_.rock.placement.slope) < kSteepShare)
      tolerance_ = kTolerance * window.resolution;
    check_memory(window);
    report_.amplified = amplify(*report_.heightfield, report_.rock, report_.options, task_);
    report_.seconds.tiles = amplified().tile_seconds;
    report_.seconds.placement = amplified().placement_seconds;
    report_.origin = mesh_origin(*report_.heightfield, amplified().region, window.resolution);
    const Vec3& o = report_.origin;
    if (!run_.meshes.empty() && o != Vec3(report_.heightfield->lo(), 0.0))
      note("mesh positions count from " + number_text(o.x, 15) + " " + number_text(o.y, 15) + " " + number_text(o.z, 15) +
           ", near the region, so that floats hold its cells");
    if (block_count(amplified()) == 0)
      note("no ground here is steeper than " + number_text(degrees(report_.rock.placement.slope)) +
           " degrees, or blocks are below the resolution: the terrain stays as it is");
    if (run_.dry_run || !run_.meshes.empty()) expected_ = expectation();
    if (!run_.dry_run && !streams()) require_memory(static_cast<double>(expected_.mesh.bytes));
    speak();
    watch_.lap();
  }

  /// A flat sheet over the region needs this much at least: refuses the hopeless before blocks are placed for hours.
  void check_memory(const Window& window) const {
    const PolygonizeOptions options = mesh_options();
    const Vec2 extent = window.hi - window.lo;
    const double widest = options.tolerance > 0.0 ? std::exp2(options.levels) : 1.0;
    const double cells = extent.x * extent.y / std::pow(widest * window.resolution, 2.0);
    if (run_.meshes.empty() || options.triangles > 0) return;
    const double fits = window.resolution * std::sqrt(2.0 * cells / kMostTriangles);
    require(2.0 * cells <= kMostTriangles, "--resolution", "above " + number_text(fits, 3) + " m", window.resolution);
    if (!streams()) require_memory(cells * kLeastBytesACell);
  }

  void require_memory(double bytes) const {
    const double limit = static_cast<double>(report_.memory_limit), resolution = report_.options.resolution;
    const double fits = resolution * std::sqrt(bytes / limit);
    require(bytes <= limit, "--resolution",
            "above " + number_text(fits, 3) + " m for a memory limit of " + byte_text(limit), resolution);
  }

  [[nodiscard]] PolygonizeOptions mesh_options() const {
    return {.region = amplified().region,
            .origin = report_.origin,
            .resolution = report_.options.resolution,
            .tolerance = tolerance_,
            .triangles = run_.triangles,
            .crisp = run_.crisp,
            .border = run_.solid ? Border::Closed : Border::Open,
            .parts = Parts::Grounded,
            .memory_limit = report_.memory_limit};
  }

  /// A sheet has no walls: it is cut where data are missing. A solid gets walls there, as at the region's border.
  [[nodiscard]] bool is_cut() const { return amplified().hole && !run_.solid; }

  [[nodiscard]] Expectation expectation() const {
    const bool sheet = wants_triangles({run_.meshes, {}, {}}), level_set = wants_level_set({run_.meshes, {}, {}});
    const Field& field = is_cut() && !level_set ? *amplified().ground : *amplified().field;
    Expectation expected{.mesh = estimate_polygonize(field, mesh_options(), task_)};
    expected.meshings = is_cut() ? std::size_t{sheet} + level_set : std::size_t{sheet || level_set};
    const Vec3 cells = amplified().region.size() / report_.options.resolution;
    if (level_set)
      expected.level_set_cells = double(expected.mesh.cells) + cells.x * cells.y + (cells.x + cells.y) * cells.z;
    return expected;
  }

  [[nodiscard]] MeshMetadata metadata() const {
    return {comments(report_), amplified().label_names, amplified().label_colours, report_.origin};
  }

  /// All but level sets and sheets cut at missing data can be written while it is made.
  [[nodiscard]] bool streams() const { return !wants_level_set({run_.meshes, {}, {}}) && !is_cut(); }

  void mesh() {
    Writers writers(run_.meshes, metadata(), task_);
    if (streams()) {
      // What is meshed waits in memory for the verdict on floating parts while it fits there, else beside the first file.
      const bool fits = static_cast<double>(expected_.mesh.bytes) < kMemoryShare * static_cast<double>(report_.memory_limit);
      PieceOptions pieces{.spool = fits ? std::filesystem::path() : run_.meshes.front()};
      pieces.squares = std::clamp<std::size_t>(report_.memory_limit / kBytesASquare, 1, pieces.squares);
      report_.polygonized = polygonize_pieces(*amplified().field, mesh_options(), pieces, writers.sinks(), task_);
    } else {
      whole_mesh(writers);
    }
    if (writers.any()) report_.mesh = writers.measure();
    for (const auto& path : run_.meshes)
      if (!is_vdb(path)) written(path, count_text(double(report_.mesh->triangles())) + " triangles");
    report_.seconds.meshing = watch_.lap();
  }

  /// Makes and holds the mesh as a whole: to cut it, or to measure distances from it.
  void whole_mesh(Writers& writers) {
    const bool level_set = wants_level_set({run_.meshes, {}, {}});
    TriangleMesh solid;
    if (writers.any()) {
      PolygonizeOptions options = mesh_options();
      const bool shared = level_set && !is_cut();  // One mesh for both: a sheet is the solid without its walls.
      if (shared) options.border = Border::Closed;
      PolygonizeResult made = polygonize(is_cut() ? *amplified().ground : *amplified().field, options, task_);
      report_.polygonized = made.statistics;
      if (shared) solid = {made.mesh.origin, made.mesh.positions, {}, {}, made.mesh.triangles};
      if (shared && !run_.solid) made.mesh = without_walls(made.mesh, made.statistics.extent);
      if (is_cut()) made.mesh = clip_mesh(made.mesh, *amplified().hole);
      for (MeshSink* const sink : writers.sinks()) feed(made.mesh, *sink);
    }
    if (level_set) level_sets(solid.triangles.empty() ? solid_mesh() : solid);
  }

  /// That of --solid: nothing floats in it and no void hides. A level set holds it, whatever the meshes are.
  [[nodiscard]] TriangleMesh solid_mesh() const {
    PolygonizeOptions options = mesh_options();
    options.border = Border::Closed;
    options.normals = options.labels = false;
    return polygonize(*amplified().field, options, task_).mesh;
  }

  void level_sets(const TriangleMesh& solid) {
    for (const auto& path : run_.meshes) {
      if (!is_vdb(path)) continue;
      write_level_set(path, solid, report_.options.resolution, task_);
      written(path, "a level set");
    }
  }

  void preview() {
    const Preview picture = render_preview(*amplified().field, preview_options(run_, report_), task_);
    report_.preview = picture.statistics;
    for (const auto& path : run_.previews) {
      write_preview(path, picture);
      written(path, std::to_string(run_.width) + " x " + std::to_string(run_.height) + " pixels");
    }
    report_.seconds.preview = watch_.lap();
  }

  void write_report() {
    report_.outputs.push_back(run_.report);
    report_.seconds.total = total_.lap();
    OutputFile file(run_.report);
    file.write(report_json(report_));
    file.commit();
    say("wrote " + run_.report.string());
  }

  void written(const std::filesystem::path& path, const std::string& what) {
    report_.outputs.push_back(path);
    say("wrote " + path.string() + ": " + what);
    task_.check();
  }

  AmplifyRun run_;
  const Notify& notify_;
  const Task& task_;
  AmplifyReport report_;
  Expectation expected_;
  double tolerance_ = 0.0;  ///< Of the mesh, metres.
  Stopwatch watch_, total_;
  std::vector<std::string> waiting_;
  bool accepted_ = false;
};

}  // namespace

std::string run_amplify(AmplifyRun run, const Notify& notify, const Task& task) {
  require(run.threads >= 0, "--threads", "0 (all cores) or more", run.threads);
  const ThreadLimit limit(run.threads);
  return Runner(std::move(run), notify, task)();
}

}  // namespace outcrop
