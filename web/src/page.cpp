// SPDX-License-Identifier: Apache-2.0
#include <rths/web/page.hpp>

namespace rths::web {

extern const std::string_view kUplotJs, kUplotCss;

namespace {

// "</script>" or "<!--" in a text would end or change the enclosing element.
std::string escaped(std::string text) {
  for (auto at = text.find('<'); at != std::string::npos; at = text.find('<', at))
    text.replace(at, 1, "\\u003c");
  return text;
}

std::string joined(const std::vector<std::string_view>& files) {
  std::string text;
  for (const auto file : files) text += file;
  return text;
}

void fill_in(std::string& page, const std::string& mark, std::string_view text) {
  const auto position = page.find(mark);
  if (position != std::string::npos) page.replace(position, mark.size(), text);
}

}  // namespace

std::string assemble(const PageSections& sections, std::string data) {
  std::string page{sections.html};
  fill_in(page, "/*plot-style*/", kUplotCss);
  fill_in(page, "/*style*/", joined(sections.styles));
  fill_in(page, "/*plot-script*/", kUplotJs);
  fill_in(page, "/*script*/", joined(sections.scripts));
  fill_in(page, "/*data*/", escaped(std::move(data)));  // last, because data may contain the marks
  return page;
}

}  // namespace rths::web
