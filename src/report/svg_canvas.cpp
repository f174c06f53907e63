// SPDX-License-Identifier: BSD-3-Clause
#include "svg_canvas.h"

#include <cassert>
#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/report/xml_text.h"

namespace raven_correction {
namespace {

std::string attributes(const Paint& paint) {
  std::string text = " fill=\"" + paint.fill + "\"";
  if (paint.stroke != "none") {
    text += " stroke=\"" + paint.stroke + "\" stroke-width=\"" + pixels(paint.width) + "\"";
    if (paint.pattern == Stroke::kDashed) text += " stroke-dasharray=\"6 3\"";
    if (paint.pattern == Stroke::kDotted) text += " stroke-dasharray=\"1.5 2.5\"";
  }
  if (paint.opacity < 1.0) text += format(" opacity=\"%.2f\"", paint.opacity);
  return text;
}

std::string at(const char* x, const char* y, const Pixel& pixel) {
  return std::string(" ") + x + "=\"" + pixels(pixel.x) + "\" " + y + "=\"" + pixels(pixel.y) +
         "\"";
}

}  // namespace

bool isFinite(const Pixel& pixel) { return std::isfinite(pixel.x) && std::isfinite(pixel.y); }

std::string pixels(double value) {
  assert(std::isfinite(value));  // the canvas leaves out what is not
  if (!std::isfinite(value)) return "0";
  std::string text = format("%.1f", value);
  if (text.compare(text.size() - 2, 2, ".0") == 0) text.resize(text.size() - 2);
  return text == "-0" ? "0" : text;
}

void SvgCanvas::line(const Pixel& from, const Pixel& to, const Paint& paint) {
  if (!isFinite(from) || !isFinite(to)) return;
  out_ += "<line" + at("x1", "y1", from) + at("x2", "y2", to) + attributes(paint) + "/>";
}

void SvgCanvas::rectangle(const Pixel& corner, double width, double height, const Paint& paint) {
  if (!isFinite(corner) || !std::isfinite(width) || !std::isfinite(height)) return;
  out_ += "<rect" + at("x", "y", corner) + " width=\"" + pixels(std::max(0.0, width)) +
          "\" height=\"" + pixels(std::max(0.0, height)) + "\"" + attributes(paint) + "/>";
}

void SvgCanvas::path(const std::string& data, const Paint& paint) {
  if (data.empty()) return;
  out_ += "<path d=\"" + data + "\"" + attributes(paint) + " stroke-linejoin=\"round\"/>";
}

void SvgCanvas::dots(const std::vector<Pixel>& points, Marker marker, double size,
                     const std::string& colour, double opacity) {
  std::string data;
  const std::string s = pixels(size), half = pixels(0.5 * size), back = pixels(-size);
  for (const Pixel& point : points) {
    if (!isFinite(point)) continue;
    switch (marker) {
      case Marker::kCircle:
      case Marker::kSquare:
        data += "M" + pixels(point.x) + " " + pixels(point.y) + "h0";
        break;
      case Marker::kTriangle:
        data += "M" + pixels(point.x - 0.5 * size) + " " + pixels(point.y + 0.5 * size) + "h" + s +
                "l-" + half + " " + back + "z";
        break;
      case Marker::kDiamond:
        data += "M" + pixels(point.x - 0.6 * size) + " " + pixels(point.y) + "l" +
                pixels(0.6 * size) + " " + pixels(-0.6 * size) + "l" + pixels(0.6 * size) + " " +
                pixels(0.6 * size) + "l" + pixels(-0.6 * size) + " " + pixels(0.6 * size) + "z";
        break;
    }
  }
  if (data.empty()) return;
  const std::string faint = opacity < 1.0 ? format(" opacity=\"%.2f\"", opacity) : "";
  if (marker == Marker::kCircle || marker == Marker::kSquare)
    out_ += "<path d=\"" + data + "\" fill=\"none\" stroke=\"" + colour + "\" stroke-width=\"" + s +
            "\" stroke-linecap=\"" + (marker == Marker::kCircle ? "round" : "square") + "\"" +
            faint + "/>";
  else
    out_ += "<path d=\"" + data + "\" fill=\"" + colour + "\"" + faint + "/>";
}

void SvgCanvas::text(const Pixel& where, const std::string& words, const char* anchor, double size,
                     const char* colour, double degrees, bool bold) {
  if (!isFinite(where)) return;
  out_ += "<text" + at("x", "y", where) + " text-anchor=\"" + anchor + "\" font-size=\"" +
          pixels(size) + "\" fill=\"" + colour + "\"";
  if (bold) out_ += " font-weight=\"600\"";
  if (degrees != 0.0)
    out_ += " transform=\"rotate(" + pixels(degrees) + " " + pixels(where.x) + " " +
            pixels(where.y) + ")\"";
  out_ += ">" + xmlText(words) + "</text>";
}

std::string polyline(const std::vector<Pixel>& points) {
  std::string data;
  bool drawing = false;
  for (const Pixel& point : points) {
    if (!isFinite(point)) {
      drawing = false;
      continue;
    }
    data += (drawing ? "L" : "M") + pixels(point.x) + " " + pixels(point.y);
    drawing = true;
  }
  return data;
}

double textWidth(const std::string& words, double size) {
  double letters = 0.0;
  for (const char c : words)
    if ((static_cast<unsigned char>(c) & 0xC0U) != 0x80U) letters += 1.0;  // not inside a sequence
  return 0.56 * size * letters;
}

}  // namespace raven_correction
