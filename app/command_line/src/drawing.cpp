// SPDX-License-Identifier: Apache-2.0
#include <rths/command_line/drawing.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::app {
namespace {

constexpr double kPanelWidth = 360, kPanelHeight = 270;  // of the axes' box
constexpr double kLeft = 62, kRight = 18, kTop = 52, kBottom = 46;
constexpr double kThinning = 0.15;  // points nearer to the line are left out [pixels]
constexpr int kTicks = 5;
constexpr double kSmallestSpan = 1e-9;  // of the values
constexpr const char* kColours[] = {"#1f5fa8", "#c8501e", "#2e8b57", "#7b4ea3", "#b8860b"};
constexpr const char* kReferenceColour = "#9aa0a6";

struct DrawnRange {
  double low, high, step;
};

// Limits and ticks on round numbers.
DrawnRange round_range(double low, double high) {
  // Variation at the level of round-off counts as a constant.
  const double smallest = kSmallestSpan * std::max(std::abs(low), std::abs(high));
  if (!(high - low > smallest)) high = low + std::max(1.0, std::abs(low)), low = low - (high - low);
  const double raw = (high - low) / kTicks;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10 * power;
  for (const double candidate : {1.0, 2.0, 5.0})
    if (candidate * power >= raw * 0.999) {
      step = candidate * power;
      break;
    }
  return {std::floor(low / step + 1e-9) * step, std::ceil(high / step - 1e-9) * step, step};
}

DrawnRange range_of(const Panel& panel, std::vector<double> Curve::*values) {
  double low = INFINITY, high = -INFINITY;
  for (const auto& curve : panel.curves)
    for (const double value : curve.*values)
      low = std::min(low, value), high = std::max(high, value);
  return round_range(low, high);
}

std::string xml_escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '<')
      result += "&lt;";
    else if (c == '&')
      result += "&amp;";
    else
      result += c;
  }
  return result;
}

struct Point {
  double x, y;
};

double distance_to_segment(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double square = dx * dx + dy * dy;
  const double along = square > 0 ? ((p.x - a.x) * dx + (p.y - a.y) * dy) / square : 0;
  const double share = std::clamp(along, 0.0, 1.0);
  return std::hypot(p.x - a.x - share * dx, p.y - a.y - share * dy);
}

// Leaves out points on straight lines (Douglas & Peucker 1973).
void thin(const std::vector<Point>& points, std::size_t first, std::size_t last,
          std::vector<bool>& kept) {
  std::vector<std::pair<std::size_t, std::size_t>> open{{first, last}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    double farthest = 0;
    std::size_t at = a;
    for (std::size_t i = a + 1; i < b; ++i) {
      const double distance = distance_to_segment(points[i], points[a], points[b]);
      if (distance > farthest) farthest = distance, at = i;
    }
    if (farthest <= kThinning) continue;
    kept[at] = true;
    open.emplace_back(a, at);
    open.emplace_back(at, b);
  }
}

class PanelDrawing {
 public:
  PanelDrawing(const Panel& panel, double left)
      : panel_{panel},
        left_{left},
        x_{range_of(panel, &Curve::x)},
        y_{range_of(panel, &Curve::y)} {}

  [[nodiscard]] std::string svg() const {
    std::string out = fmt::format("<g transform=\"translate({:g} {:g})\">\n", left_, kTop);
    out += axes();
    for (const bool reference : {true, false})
      for (std::size_t i = 0; i < panel_.curves.size(); ++i)
        if (panel_.curves[i].is_reference == reference) out += line(i);
    return out + legend() + "</g>\n";
  }

 private:
  [[nodiscard]] double at_x(double x) const {
    return (x - x_.low) / (x_.high - x_.low) * kPanelWidth;
  }
  [[nodiscard]] double at_y(double y) const {
    return (y_.high - y) / (y_.high - y_.low) * kPanelHeight;
  }
  [[nodiscard]] std::string colour(std::size_t curve) const {
    if (panel_.curves[curve].is_reference) return kReferenceColour;
    std::size_t index = 0;
    for (std::size_t i = 0; i < curve; ++i) index += panel_.curves[i].is_reference ? 0 : 1;
    return kColours[index % std::size(kColours)];
  }

  [[nodiscard]] std::string axes() const {
    std::string out =
        fmt::format("<text class=\"h\" x=\"0\" y=\"-12\">{}</text>\n", xml_escaped(panel_.title));
    const auto tick_count = [](const DrawnRange& r) {
      return static_cast<int>(std::lround((r.high - r.low) / r.step));
    };
    for (int i = 0; i <= tick_count(x_); ++i) {
      const double value = x_.low + i * x_.step, x = at_x(value);
      out += fmt::format(
          "<path class=\"g\" d=\"M{0:.1f} 0V{1:g}\"/><text x=\"{0:.1f}\" y=\"{2:g}\" "
          "text-anchor=\"middle\">{3}</text>\n",
          x, kPanelHeight, kPanelHeight + 16, label(value, x_.step));
    }
    for (int i = 0; i <= tick_count(y_); ++i) {
      const double value = y_.low + i * y_.step, y = at_y(value);
      out += fmt::format(
          "<path class=\"g\" d=\"M0 {0:.1f}H{1:g}\"/><text x=\"-6\" y=\"{2:.1f}\" "
          "text-anchor=\"end\">{3}</text>\n",
          y, kPanelWidth, y + 4, label(value, y_.step));
    }
    out += fmt::format("<text x=\"{:g}\" y=\"{:g}\" text-anchor=\"middle\">{}</text>\n",
                       kPanelWidth / 2, kPanelHeight + 34, xml_escaped(panel_.x_label));
    return out + fmt::format(
                     "<text transform=\"translate({:g} {:g}) rotate(-90)\" "
                     "text-anchor=\"middle\">{}</text>\n",
                     -kLeft + 14, kPanelHeight / 2, xml_escaped(panel_.y_label));
  }

  [[nodiscard]] static std::string label(double value, double step) {
    const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
    const double shown = std::abs(value) < 1e-9 * step ? 0 : value;
    return fmt::format("{:.{}f}", shown, decimals);
  }

  [[nodiscard]] std::string line(std::size_t index) const {
    const Curve& curve = panel_.curves[index];
    std::vector<Point> points;
    for (std::size_t i = 0; i < curve.x.size(); ++i)
      points.push_back({at_x(curve.x[i]), at_y(curve.y[i])});
    std::vector<bool> kept(points.size());
    kept.front() = kept.back() = true;
    thin(points, 0, points.size() - 1, kept);
    std::string path;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (kept[i])
        path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", points[i].x, points[i].y);
    return fmt::format("<path class=\"c\" stroke=\"{}\" stroke-width=\"{}\" d=\"{}\"/>\n",
                       colour(index), curve.is_reference ? "1.2" : "1.6", path);
  }

  [[nodiscard]] std::string legend() const {
    std::string out;
    double y = 14;
    for (std::size_t i = 0; i < panel_.curves.size(); ++i) {
      if (panel_.curves[i].label.empty()) continue;
      out += fmt::format(
          "<path class=\"c\" stroke=\"{}\" stroke-width=\"2\" d=\"M8 {:g}h16\"/>"
          "<text x=\"30\" y=\"{:g}\">{}</text>\n",
          colour(i), y, y + 4, xml_escaped(panel_.curves[i].label));
      y += 15;
    }
    return out;
  }

  const Panel& panel_;
  double left_;
  DrawnRange x_, y_;
};

void check(const std::vector<Panel>& panels) {
  for (const auto& panel : panels)
    for (const auto& curve : panel.curves)
      if (curve.x.empty() || curve.x.size() != curve.y.size())
        throw Error{fmt::format(
            "drawing '{}': a curve has {} x and {} y, expected equal numbers, at least 1",
            panel.title, curve.x.size(), curve.y.size())};
}

}  // namespace

std::string draw(const std::string& title, const std::vector<Panel>& panels) {
  check(panels);
  const double slot = kLeft + kPanelWidth + kRight;
  const double width = slot * static_cast<double>(panels.size());
  const double height = kTop + kPanelHeight + kBottom;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" "
      "height=\"{1:g}\">\n<style>text{{font:12px sans-serif;fill:#333}}.t{{font-size:14px;"
      "font-weight:600}}.h{{fill:#555}}.g{{stroke:#e3e6e8;fill:none}}.c{{fill:none;"
      "stroke-linejoin:round}}</style>\n<rect width=\"{0:g}\" height=\"{1:g}\" fill=\"#fff\"/>\n"
      "<text class=\"t\" x=\"{2:g}\" y=\"20\">{3}</text>\n",
      width, height, kLeft, xml_escaped(title));
  for (std::size_t i = 0; i < panels.size(); ++i)
    svg += PanelDrawing{panels[i], kLeft + slot * static_cast<double>(i)}.svg();
  return svg + "</svg>\n";
}

}  // namespace rths::app
