// Numbers in texts, whatever the locale of the program around this library.
#include <clocale>
#include <cstdlib>
#include <string>

#include "base/number_text.h"
#include "catch.h"
#include "fresh_folder.h"
#include "scene/inflow_table.h"

using namespace frana;

TEST_CASE("A number in a text is all of it, with a point", "[base]") {
    CHECK(number_in("1.5") == 1.5);
    CHECK(number_in(" +1.5e3") == 1500.0);
    CHECK(number_in("-2") == -2.0);
    for (const char* no : {"", " ", "+", "+-1", "1,5", "1.5 ", "1.5m", "0x10", "x", "1e999"}) {
        INFO(no);
        CHECK_FALSE(number_in(no).has_value());
    }
    CHECK(leading_number(" 2.5 m/s")->value == 2.5);
    CHECK(leading_number("2.5 m/s")->length == 3);
}

namespace {

/// Decimal commas for as long as it lives, as Python and QGIS set them for their users; made by localedef (package locales).
class DecimalCommas {
public:
    DecimalCommas() : before_(std::setlocale(LC_NUMERIC, nullptr)) {
        const std::string folder = folder_.path().string();
        const std::string make = "localedef -i de_DE -f UTF-8 " + folder + "/commas > " + folder + "/log 2>&1";
        made_ = std::system(make.c_str()) == 0;
        ::setenv("LOCPATH", folder.c_str(), 1);
        if (made_) made_ = std::setlocale(LC_NUMERIC, "commas") != nullptr;
        ::unsetenv("LOCPATH");
    }
    ~DecimalCommas() { std::setlocale(LC_NUMERIC, before_.c_str()); }
    bool made() const { return made_; }

private:
    FreshFolder folder_;
    std::string before_;
    bool made_ = false;
};

}  // namespace

TEST_CASE("A locale with decimal commas changes no number that is read", "[base][inflow]") {
    const DecimalCommas commas;
    if (commas.made())
        CHECK(std::strtod("1.5", nullptr) == 1.0);  // what went wrong
    else
        WARN("no locale with decimal commas can be made: this shows nothing");
    CHECK(number_in("1.5") == 1.5);
    const Hydrograph table = parse_hydrograph("t_s,discharge [m3/s]\n0,0.25\n1.5,2.75\n", "table.csv");
    CHECK(table.time.at(1) == 1.5);
    CHECK(table.discharge == std::vector<double>{0.25, 2.75});
}
