#include "materials/index/expression.h"

#include <fmt/format.h>

#include <miebrdf/error.h>

#ifdef MIEBRDF_HAS_MUPARSER
#include <muParser.h>

#include <mutex>

#include <miebrdf/index.h>

namespace miebrdf::materials {

struct Expression::Parser {
    std::mutex mutex;  // of the variables
    double um = 0.5, nm = 500.0, ev = 2.5;
    mu::Parser parser;
};

Expression::Expression(const std::string& text) : parser_(std::make_shared<Parser>()) {
    try {
        parser_->parser.DefineVar("um", &parser_->um);
        parser_->parser.DefineVar("nm", &parser_->nm);
        parser_->parser.DefineVar("eV", &parser_->ev);
        parser_->parser.SetExpr(text);
        parser_->parser.Eval();  // reads it
    } catch (const mu::ParserError& error) {
        throw UsageError(fmt::format("formula '{}': {}; variables: um, nm, eV", text,
                                     std::string(error.GetMsg())));
    }
}

double Expression::at(double wavelength_nm) const {
    const std::lock_guard lock(parser_->mutex);
    parser_->nm = wavelength_nm;
    parser_->um = from_nm(wavelength_nm, Unit::micrometre);
    parser_->ev = from_nm(wavelength_nm, Unit::electronvolt);
    return parser_->parser.Eval();
}

}  // namespace miebrdf::materials

#else

namespace miebrdf::materials {

struct Expression::Parser {};

Expression::Expression(const std::string& text) {
    throw UsageError(fmt::format(
        "formula '{}': this build reads no formulas, muParser was not there (Debian: apt install "
        "libmuparser-dev, then build again)",
        text));
}

double Expression::at(double) const { return 0.0; }

}  // namespace miebrdf::materials

#endif
