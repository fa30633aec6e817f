#include "materials/index/expression.h"

#include <fmt/format.h>

#include <miebrdf/error.h>

#ifdef MIEBRDF_HAS_MUPARSER
#include <muParserDLL.h>

#include <mutex>

#include <miebrdf/index.h>

namespace miebrdf::materials {
namespace {

/// muParser writes its reasons, which repeat words of the formula, into 2048 characters that all
/// parsers share.
constexpr std::size_t kLongestFormula = 1000;

std::string take_reason(muParserHandle_t parser) {
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    return mupGetErrorMsg(parser);
}

}  // namespace

struct Expression::Parser {
    std::mutex mutex;  // of the variables
    double um = 0.5, nm = 500.0, ev = 2.5;
    const muParserHandle_t handle = mupCreate(muBASETYPE_FLOAT);

    Parser() = default;
    Parser(const Parser&) = delete;
    Parser& operator=(const Parser&) = delete;
    ~Parser() { mupRelease(handle); }
};

Expression::Expression(const std::string& text) : parser_(std::make_shared<Parser>()) {
    if (text.size() > kLongestFormula)
        throw UsageError(fmt::format("formula '{}...': {} characters; allowed: up to {}",
                                     text.substr(0, 40), text.size(), kLongestFormula));
    mupDefineVar(parser_->handle, "um", &parser_->um);
    mupDefineVar(parser_->handle, "nm", &parser_->nm);
    mupDefineVar(parser_->handle, "eV", &parser_->ev);
    mupSetExpr(parser_->handle, text.c_str());
    mupEval(parser_->handle);  // reads it
    if (mupError(parser_->handle) != 0)
        throw UsageError(fmt::format("formula '{}': {}; variables: um, nm, eV", text,
                                     take_reason(parser_->handle)));
}

double Expression::at(double wavelength_nm) const {
    const std::lock_guard lock(parser_->mutex);
    parser_->nm = wavelength_nm;
    parser_->um = from_nm(wavelength_nm, Unit::micrometre);
    parser_->ev = from_nm(wavelength_nm, Unit::electronvolt);
    return mupEval(parser_->handle);
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
