#include "outcrop/fracture/orientations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <numeric>
#include <string>

#include "outcrop/core/error.h"
#include "outcrop/core/file.h"

namespace outcrop {
namespace {

constexpr double kLeastTerzaghi =
    radians(15.0);  // Below this angle to the line, weights would be noise (Terzaghi 1965).

constexpr double kMostDirection = 720.0;  // Degrees: jittered readings run past north, typing errors farther.

Vec3 upward(const Vec3& v) {
  const bool is_down = v.z < 0.0 || (v.z == 0.0 && (v.y < 0.0 || (v.y == 0.0 && v.x < 0.0)));
  return is_down ? -v : v;
}

// The eigenvector of the largest eigenvalue of a symmetric matrix, by Jacobi's rotations.
Vec3 first_eigenvector(Mat3 m) {
  Mat3 vectors(1.0);
  for (int sweep = 0; sweep < 12; ++sweep)
    for (const auto& [p, q] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
      if (std::abs(m[p][q]) < 1e-300) continue;
      const double theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
      const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
      const double c = 1.0 / std::sqrt(t * t + 1.0);
      Mat3 turn(1.0);
      turn[p][p] = turn[q][q] = c;
      turn[p][q] = -t * c;
      turn[q][p] = t * c;
      m = glm::transpose(turn) * m * turn;
      vectors = vectors * turn;
    }
  int best = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (m[axis][axis] > m[best][best]) best = axis;
  return glm::normalize(vectors[best]);
}

void check_weights(std::span<const Vec3> poles, std::span<const double> weights) {
  require(weights.empty() || weights.size() == poles.size(), "weights", "none, or one a pole",
          static_cast<double>(weights.size()));
}

/// One Fisher distribution of axes in the mixture.
struct Component {
  Vec3 mean{0, 0, 1};
  double kappa = 20.0;
  double share = 0.0;

  // Density on the half sphere: both ends of the axis count.
  [[nodiscard]] double density(const Vec3& pole) const {
    const double c = std::abs(glm::dot(mean, pole));
    return kappa / (2.0 * kPi * (1.0 - std::exp(-2.0 * kappa))) *
           (std::exp(kappa * (c - 1.0)) + std::exp(-kappa * (c + 1.0)));
  }
};

/// Fisher distributions over a uniform background, and how well they explain the poles.
class Mixture {
 public:
  Mixture(std::span<const Vec3> poles, std::vector<double> weights)
      : poles_(poles), weights_(std::move(weights)), background_(poles.size(), 1.0) {}

  // Adds a component where the background's poles are densest.
  void add() {
    double most = -1.0;
    Component component{.kappa = kSeedKappa};
    const Component kernel{.kappa = kSeedKappa};
    for (const Vec3& at : poles_) {
      Component here = kernel;
      here.mean = at;
      double sum = 0.0;
      for (std::size_t i = 0; i < poles_.size(); ++i) sum += weights_[i] * background_[i] * here.density(poles_[i]);
      if (sum > most) {
        most = sum;
        component.mean = at;
      }
    }
    component.share = std::max(0.5 * random_, kLeastShare);
    random_ *= 0.5;
    components_.push_back(component);
  }

  // Expectation maximisation, until the likelihood rests.
  void fit() {
    double before = -std::numeric_limits<double>::infinity();
    for (int step = 0; step < kSteps; ++step) {
      expect();
      if (likelihood_ - before < kRest * static_cast<double>(poles_.size())) break;
      before = likelihood_;
      maximise();
    }
  }

  // Schwarz's criterion, less is better: four numbers a component (mean, κ, share).
  [[nodiscard]] double criterion() const {
    const double numbers = 4.0 * static_cast<double>(components_.size());
    return numbers * std::log(static_cast<double>(poles_.size())) - 2.0 * likelihood_;
  }

  // The component that most likely made a pole; −1: the background.
  [[nodiscard]] int owner(const Vec3& pole) const {
    int best = -1;
    double most = random_ * kUniform;
    for (std::size_t k = 0; k < components_.size(); ++k)
      if (const double p = components_[k].share * components_[k].density(pole); p > most) {
        most = p;
        best = static_cast<int>(k);
      }
    return best;
  }
  [[nodiscard]] std::size_t size() const { return components_.size(); }
  [[nodiscard]] double least_share() const {
    double least = 1.0;
    for (const Component& component : components_) least = std::min(least, component.share);
    return least;
  }

 private:
  static constexpr double kUniform = 1.0 / (2.0 * kPi);
  static constexpr double kSeedKappa = 40.0;  // 13° of scatter: what a set may have to be seen as one.
  static constexpr double kLeastKappa = 5.0;  // Wider, and it is no set but a girdle or the background.
  static constexpr double kMostKappa = 5000.0;
  static constexpr double kLeastShare = 1e-3;
  static constexpr double kRest = 1e-7;  // Gain of log-likelihood a pole.
  static constexpr int kSteps = 200;

  void expect() {
    responsibilities_.assign(components_.size(), std::vector<double>(poles_.size()));
    likelihood_ = 0.0;
    for (std::size_t i = 0; i < poles_.size(); ++i) {
      double sum = random_ * kUniform;
      for (std::size_t k = 0; k < components_.size(); ++k) {
        responsibilities_[k][i] = components_[k].share * components_[k].density(poles_[i]);
        sum += responsibilities_[k][i];
      }
      for (std::vector<double>& r : responsibilities_) r[i] /= sum;
      background_[i] = random_ * kUniform / sum;
      likelihood_ += weights_[i] * std::log(sum);
    }
  }

  void maximise() {
    const auto all = static_cast<double>(poles_.size());
    random_ = 0.0;
    for (std::size_t i = 0; i < poles_.size(); ++i) random_ += weights_[i] * background_[i] / all;
    for (std::size_t k = 0; k < components_.size(); ++k) {
      Component& component = components_[k];
      Vec3 sum{0.0};
      double weight = 0.0;
      for (std::size_t i = 0; i < poles_.size(); ++i) {
        const double w = weights_[i] * responsibilities_[k][i];
        sum += (glm::dot(poles_[i], component.mean) < 0.0 ? -w : w) * poles_[i];
        weight += w;
      }
      component.share = weight / all;
      const double length = glm::length(sum);
      if (!(weight > 0.0) || !(length > 0.0)) continue;
      component.mean = sum / length;
      const double r = std::min(length / weight, 1.0 - 1e-9);
      component.kappa = std::clamp(r * (3.0 - r * r) / (1.0 - r * r), kLeastKappa, kMostKappa);  // Banerjee et al. 2005
    }
  }

  std::span<const Vec3> poles_;
  std::vector<double> weights_;     // Mean 1.
  std::vector<double> background_;  // Of each pole: the chance that no component made it.
  std::vector<Component> components_;
  std::vector<std::vector<double>> responsibilities_;
  double random_ = 1.0;
  double likelihood_ = 0.0;
};

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") + 1 - first);
}

// The numbers of a line; nothing when a word is none.
std::vector<double> numbers_of(std::string_view line) {
  std::vector<double> numbers;
  std::string text(line);
  std::replace(text.begin(), text.end(), ',', ' ');
  std::replace(text.begin(), text.end(), ';', ' ');
  const char* at = text.c_str();
  while (*(at += std::strspn(at, " \t\r"))) {
    char* end = nullptr;
    numbers.push_back(std::strtod(at, &end));
    if (end == at || (*end && !std::strchr(" \t\r", *end)) || !std::isfinite(numbers.back())) return {};
    at = end;
  }
  return numbers;
}

}  // namespace

Vec3 normal_of(const Orientation& orientation) noexcept {
  const double s = std::sin(orientation.dip);
  return {s * std::sin(orientation.dip_direction), s * std::cos(orientation.dip_direction), std::cos(orientation.dip)};
}

Orientation orientation_of(const Vec3& normal) noexcept {
  const Vec3 n = upward(normal);
  const double level = std::hypot(n.x, n.y);
  if (level == 0.0) return {};
  const double direction = std::atan2(n.x, n.y);
  return {std::atan2(level, n.z), direction < 0.0 ? direction + 2.0 * kPi : direction};
}

AxisStatistics axis_statistics(std::span<const Vec3> poles, std::span<const double> weights) {
  check_weights(poles, weights);
  AxisStatistics result;
  Mat3 moments(0.0);
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < poles.size(); ++i) {
    const double w = weights.empty() ? 1.0 : weights[i];
    sum += w;
    squares += w * w;
    for (int c = 0; c < 3; ++c) moments[c] += w * poles[i][c] * poles[i];
  }
  if (!(sum > 0.0)) return result;
  result.mean = upward(first_eigenvector(moments));
  Vec3 folded{0.0};
  for (std::size_t i = 0; i < poles.size(); ++i) {
    const double w = weights.empty() ? 1.0 : weights[i];
    folded += (glm::dot(poles[i], result.mean) < 0.0 ? -w : w) * poles[i];
  }
  result.count = sum * sum / squares;
  result.resultant = std::min(glm::length(folded) / sum, 1.0);
  if (result.count > 1.0) result.kappa = (result.count - 1.0) / (result.count * (1.0 - result.resultant));
  return result;
}

double terzaghi_weight(const Vec3& pole, const Vec3& line) noexcept {
  return 1.0 / std::max(std::abs(glm::dot(pole, line)), std::sin(kLeastTerzaghi));
}

FoundSets find_joint_sets(std::span<const Vec3> poles, const FindSetsOptions& options,
                          std::span<const double> weights) {
  check_weights(poles, weights);
  require(options.most_sets >= 1 && options.most_sets <= 20, "most_sets", "in 1 … 20", options.most_sets);
  require(options.sets >= 0 && options.sets <= options.most_sets, "sets", "in 0 … most_sets", options.sets);
  require(options.least_share >= 0.0 && options.least_share < 1.0, "least_share", "in [0, 1)", options.least_share);
  FoundSets result;
  result.set_of.assign(poles.size(), -1);
  if (poles.empty()) return result;
  std::vector<double> mean_one(poles.size(), 1.0);
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (total > 0.0)
    for (std::size_t i = 0; i < poles.size(); ++i) mean_one[i] = weights[i] * static_cast<double>(poles.size()) / total;

  Mixture mixture(poles, mean_one);
  mixture.fit();
  Mixture best = mixture;
  const int most = options.sets > 0 ? options.sets : options.most_sets;
  while (static_cast<int>(mixture.size()) < most) {
    mixture.add();
    mixture.fit();
    const bool found = mixture.criterion() < best.criterion() && mixture.least_share() >= options.least_share;
    if (options.sets > 0 || found) best = mixture;
  }

  result.sets.resize(best.size());
  std::vector<double> held(best.size(), 0.0);
  for (std::size_t i = 0; i < poles.size(); ++i) {
    result.set_of[i] = best.owner(poles[i]);
    if (result.set_of[i] >= 0) held[static_cast<std::size_t>(result.set_of[i])] += mean_one[i];
  }
  std::vector<int> order(best.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return held[std::size_t(a)] > held[std::size_t(b)]; });
  std::vector<int> rank(best.size());
  for (std::size_t k = 0; k < order.size(); ++k) rank[static_cast<std::size_t>(order[k])] = static_cast<int>(k);
  double random = 0.0;
  for (std::size_t i = 0; i < poles.size(); ++i) {
    int& set = result.set_of[i];
    if (set < 0) {
      random += mean_one[i];
      continue;
    }
    set = rank[static_cast<std::size_t>(set)];
    result.sets[static_cast<std::size_t>(set)].members.push_back(static_cast<std::uint32_t>(i));
  }
  result.random_share = random / static_cast<double>(poles.size());
  for (FoundSet& set : result.sets) {
    std::vector<Vec3> own;
    std::vector<double> own_weights;
    for (const std::uint32_t i : set.members) {
      own.push_back(poles[i]);
      own_weights.push_back(mean_one[i]);
    }
    set.statistics = axis_statistics(own, own_weights);
  }
  return result;
}

std::vector<Orientation> read_orientations(const std::filesystem::path& path) {
  return parse_orientations(read_text(path), path.string());
}

std::vector<Orientation> parse_orientations(std::string_view text, std::string_view name) {
  std::vector<Orientation> result;
  int line_number = 0;
  const auto fail = [&](std::string_view line) {
    throw InputError(std::string(name) + ":" + std::to_string(line_number) +
                     ": expected dip (0 to 90) and dip direction (0 to 360) in degrees, got \"" +
                     std::string(line.substr(0, 60)) + "\"");
  };
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = trimmed(text.substr(0, std::min(end, text.find('#'))));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    ++line_number;
    if (line.empty()) continue;
    const std::vector<double> numbers = numbers_of(line);
    if (numbers.size() != 2 || numbers[0] < 0.0 || numbers[0] > 90.0 || std::abs(numbers[1]) > kMostDirection)
      fail(line);
    result.push_back({radians(numbers[0]), radians(numbers[1] - 360.0 * std::floor(numbers[1] / 360.0))});
  }
  if (result.empty())
    throw InputError(std::string(name) + ": expected dip and dip direction in degrees a line, got no measurement");
  return result;
}

}  // namespace outcrop
