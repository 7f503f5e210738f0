#include "outcrop/fracture/tile_figure.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "outcrop/core/json.h"
#include "outcrop/fracture/rock_formulas.h"
#include "tile_figure_panels.h"

namespace outcrop {
namespace {

constexpr Vec2 kPage{1000.0, 1414.0};  // A4 upright.
constexpr double kMargin = 40.0;

std::string number(double value, int digits = 3) { return short_number(value, digits); }

void heading(Svg& svg, const Vec2& at, double width, std::string_view words) {
  svg.text(at, words, {.size = 14, .bold = true});
  svg.line(at + Vec2(0, 6), at + Vec2(width, 6), {.stroke = "#999", .width = 0.8});
}

/// Rows of cells: the first row is the head, the first column is flush left.
void table(Svg& svg, const Vec2& corner, const std::vector<double>& right_edges,
           const std::vector<std::vector<std::string>>& rows) {
  double y = corner.y;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      const TextStyle style{.size = 11.5, .anchor = c ? "end" : "start", .fill = r ? "#222" : "#555", .bold = r == 0};
      svg.text({corner.x + (c ? right_edges[c - 1] : 0.0), y}, rows[r][c], style);
    }
    if (r == 0)
      svg.line({corner.x, y + 5.0}, {corner.x + right_edges.back(), y + 5.0}, {.stroke = "#999", .width = 0.7});
    y += r == 0 ? 20.0 : 16.5;
  }
}

std::vector<std::vector<std::string>> set_rows(const RockStatistics& rock) {
  std::vector<std::vector<std::string>> rows{
      {"joints", "number", "dip / direction", "κ̂", "spacing, m", "CV", "P32, 1/m", "trace: mean, m", "median, m"}};
  for (const SetStatistics& set : rock.sets) {
    if (rows.size() > 12) {
      rows.push_back({"… and more, see the JSON"});
      break;
    }
    std::array<std::string, 8> cells;
    cells.fill("–");
    if (set.joints > 0) cells[0] = std::to_string(set.joints);
    if (set.set >= 0 && set.joints > 0) {
      const Orientation mean = orientation_of(set.orientation.mean);
      char text[32];
      std::snprintf(text, sizeof text, "%02.0f / %03.0f", degrees(mean.dip), degrees(mean.dip_direction));
      cells[1] = text;
      if (set.joints > 1) cells[2] = set.orientation.kappa > 1e4 ? "> 10⁴" : number(set.orientation.kappa);
    }
    if (set.spacing > 0.0) cells[3] = number(set.spacing);
    if (set.spacings > 1) cells[4] = number(set.spacing_cv, 2);
    cells[5] = number(set.p32);
    if (set.trace_mean > 0.0) {
      cells[6] = number(set.trace_mean);
      cells[7] = number(set.trace_median);
    }
    std::vector<std::string> row{set.name};
    row.insert(row.end(), cells.begin(), cells.end());
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string three(const Quantiles& q) { return number(q.d10) + " / " + number(q.d50) + " / " + number(q.d90); }

std::string shown_class(std::string_view words) { return " (" + std::string(words) + ")"; }

}  // namespace

TileReport tile_report(const Tile& tile, std::string title, std::vector<std::string> notes, const Mat3& map_from_tile,
                       const Task& task) {
  TileReport report{std::move(title), std::move(notes),         tile.type,
                    map_from_tile,    measure_rock(tile, task), classify(tile)};
  for (SetStatistics& set : report.statistics.sets) set.orientation.mean = map_from_tile * set.orientation.mean;
  return report;
}

std::string tile_figure_svg(const Tile& tile, const TileReport& report) {
  const RockStatistics& rock = report.statistics;
  const RockCells cells(tile);
  Svg svg;
  svg.text({kMargin, 58}, report.title, {.size = 26, .bold = true});
  double y = 82.0;
  const std::string made = "Tile of " + number(tile.side) + " m: " + std::to_string(tile.blocks.size()) +
                           " blocks, mean " + number(rock.volume_mean) + " m³; Jv " + number(rock.jv) +
                           " 1/m; blocks are " + std::string(name(report.found.type)) + ".";
  svg.text({kMargin, y}, made, {.size = 13});
  for (const std::string& note : report.notes) svg.text({kMargin, y += 18.0}, note, {.size = 12, .fill = "#555"});
  y += 36.0;

  const double half = 0.5 * (kPage.x - 3.0 * kMargin);
  const double right = kMargin + half + kMargin;
  heading(svg, {kMargin, y}, half, "Blocks, faces coloured by joint set");
  heading(svg, {right, y}, half, "Orientation of joints");
  draw_blocks(svg, {{kMargin, y + 16.0}, {half, 450.0}}, tile, report.map_from_tile);
  draw_stereonet(svg, {{right, y + 16.0}, {half, 450.0}}, tile, cells, report);
  y += 505.0;

  const double third = (kPage.x - 2.0 * kMargin - 48.0) / 3.0;
  const std::array<const char*, 3> titles{"Block volumes", "Block shapes", "Traces along the bedding"};
  for (std::size_t i = 0; i < 3; ++i)
    heading(svg, {kMargin + static_cast<double>(i) * (third + 24.0), y}, third, titles[i]);
  draw_volumes(svg, {{kMargin, y + 16.0}, {third, third}}, rock);
  draw_shapes(svg, {{kMargin + third + 24.0, y + 16.0}, {third, third}}, rock);
  draw_traces(svg, {{kMargin + 2.0 * (third + 24.0), y + 16.0}, {third, third}}, tile, cells, report.map_from_tile);
  y += third + 62.0;

  heading(svg, {kMargin, y}, kPage.x - 2.0 * kMargin, "Joint sets, as found in the tile");
  const auto rows = set_rows(rock);
  table(svg, {kMargin, y + 26.0}, {195, 320, 405, 510, 585, 680, 805, 920}, rows);
  y += 26.0 + 20.0 + 16.5 * static_cast<double>(rows.size()) + 16.0;

  heading(svg, {kMargin, y}, kPage.x - 2.0 * kMargin, "The rock");
  const std::vector<std::vector<std::string>> left_rows{
      {"block volume, m³", ""},
      {"mean, CV",
       number(rock.volume_mean) + ", " + number(rock.volume_cv, 2) + shown_class(volume_class(rock.volume_mean))},
      {"D10 / D50 / D90 by number", three(rock.volume_by_number)},
      {"D10 / D50 / D90 by volume", three(rock.volume_by_volume)},
      {"faces a block", number(rock.faces_mean)},
      {"elongation, flatness", number(rock.elongation) + ", " + number(rock.flatness)},
      {"β = Vb Jv³", number(rock.beta) + shown_class(shape_class(rock.beta))},
      {"cracks, overlaps", number(100.0 * rock.gap_share, 2) + " %, " + number(100.0 * rock.overlap_share, 2) + " %"}};
  const std::vector<std::vector<std::string>> right_rows{
      {"joints", ""},
      {"Jv, 1/m",
       number(rock.jv) + shown_class(jv_class(rock.jv) == "medium" ? "medium-sized blocks"
                                                                   : std::string(jv_class(rock.jv)) + " blocks")},
      {"P32 of all joints, 1/m", number(rock.p32)},
      {"joints a metre along the tile's x, y, z", number(rock.joints_per_metre[0]) + ", " +
                                                      number(rock.joints_per_metre[1]) + ", " +
                                                      number(rock.joints_per_metre[2])},
      {"RQD = 110 − 2.5 Jv; 115 − 3.3 Jv", number(rock.rqd_2005) + " %; " + number(rock.rqd_1982) + " %"},
      {"RQD across the bedding: Priest-Hudson; measured",
       number(rock.rqd_priest_hudson) + " %; " + number(rock.rqd_measured) + " %"},
      {"type that the blocks show", std::string(name(report.found.type))},
      {"face area in three sets; in three square ones",
       number(100.0 * report.found.set_share, 2) + " %; " + number(100.0 * report.found.square_share, 2) + " %"}};
  table(svg, {kMargin, y + 26.0}, {430}, left_rows);
  table(svg, {right, y + 26.0}, {kPage.x - kMargin - right}, right_rows);
  svg.text({kMargin, kPage.y - 22.0},
           "Spacing: along the mean normal. Jv: Σ 1 / spacing, and P32 for joints without a set. Classes of Jv: ISRM "
           "1978; of "
           "volume and β: Palmström 1995.",
           {.size = 10, .fill = "#777"});
  return svg.document(kPage, report.title);
}

std::string tile_figure_html(const std::vector<std::string>& svg_pages, const std::string& title) {
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>" + escaped(title) +
                     "</title>\n<style>body{margin:0;background:#ddd;text-align:center}svg{max-width:100%;height:auto;"
                     "margin:12px auto;display:block;box-shadow:0 1px 6px #888}@media print{body{background:none}"
                     "svg{margin:0;box-shadow:none;page-break-after:always}}</style>\n</head>\n<body>\n";
  for (const std::string& page : svg_pages) html += page;
  return html + "</body>\n</html>\n";
}

void write_tile_report(JsonWriter& json, const TileReport& report) {
  json.value("name", report.title).value("block_type", name(report.asked)).value("tile_side", report.statistics.side);
  json.begin_array("notes");
  for (const std::string& note : report.notes) json.item(note);
  json.end_array();
  json.value("tile_blocks", static_cast<double>(report.statistics.blocks.size()));
  const Classification& found = report.found;
  json.begin_object("found").value("block_type", name(found.type)).value("set_share", found.set_share);
  json.value("square_share", found.square_share).value("prism_share", found.prism_share);
  json.value("elongation", found.elongation).value("fabric_elongation", found.fabric_elongation);
  json.value("fabric_flatness", found.fabric_flatness).end_object();
  write_rock_statistics(json, report.statistics);
}

}  // namespace outcrop
