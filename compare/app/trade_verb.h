// `trade SCENE`.
#pragma once

#include "compare/solve/reference_run.h"
#include "compare/trade/trade.h"
#include "fast/command/command_line.h"

namespace touchstone::compare {

/// Adds the command; its variables must outlive Program::run.
void add_trade_verb(fast::Command& program, fast::VerbOptions& options, TradeOptions& trade,
                    ReferenceOptions& reference);

}  // namespace touchstone::compare
