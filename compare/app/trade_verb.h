// `trade SCENE`.
#pragma once

#include "compare/solve/reference_run.h"
#include "compare/trade/trade.h"
#include "fast/command/command_line.h"

namespace touchstone::compare {

/// Adds the verb to a command line. All four must outlive the parse.
/// @param options    shared with the other verbs that take a scene; --out is the caller's to add
/// @param reference  its options are the caller's to add
fast::Command add_trade_verb(fast::Command& program, fast::VerbOptions& options, TradeOptions& trade,
                             ReferenceOptions& reference);

}  // namespace touchstone::compare
