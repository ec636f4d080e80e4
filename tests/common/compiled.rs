//! What is left of a shader for a set of overrides: naga's module with its overrides set, without the
//! branches that constants close. Every driver's compiler closes at least those.

use std::collections::{BTreeSet, HashMap};

use wgpu::naga::{
    BinaryOperator, Block, Constant, Expression, Function, Handle, Literal, Module, Statement, UnaryOperator,
    back::pipeline_constants::process_overrides,
    compact::{KeepUnused, compact},
    valid::{Capabilities, ValidationFlags, Validator},
};

/// What can run.
#[derive(Debug)]
pub struct Compiled {
    /// Names of functions.
    pub functions: BTreeSet<String>,
    /// Names of bindings and of variables of the module.
    pub globals: BTreeSet<String>,
    /// Places where a texture is sampled.
    pub samples: usize,
}

/// The entry function `entry` of linked WGSL for these overrides.
pub fn compiled(source: &str, entry: &str, overrides: &[(&str, f64)]) -> Compiled {
    let module = nephos::gpu::validate(source).unwrap();
    let info = Validator::new(ValidationFlags::all(), Capabilities::SHADER_FLOAT16_IN_FLOAT32)
        .validate(&module)
        .unwrap();
    let stage = module.entry_points.iter().find(|point| point.name == entry).unwrap().stage;
    let constants = overrides.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    let mut module =
        process_overrides(&module, &info, Some((stage, entry)), &constants).unwrap().0.into_owned();
    while simplify(&mut module) {}
    compact(&mut module, KeepUnused::No);
    let functions = || module.functions.iter().map(|(_, function)| function);
    let all = functions().chain(module.entry_points.iter().map(|point| &point.function));
    let sampled = |(_, e): &(_, &Expression)| matches!(e, Expression::ImageSample { .. });
    Compiled {
        functions: functions().filter_map(|function| function.name.clone()).collect(),
        globals: module.global_variables.iter().filter_map(|(_, variable)| variable.name.clone()).collect(),
        samples: all.map(|function| function.expressions.iter().filter(sampled).count()).sum(),
    }
}

/// Closes branches once everywhere; whether anything changed.
fn simplify(module: &mut Module) -> bool {
    let result = |(handle, function): (_, &Function)| Some((handle, constant_result(function)?));
    let known = Known {
        results: module.functions.iter().filter_map(result).collect(),
        constants: module
            .constants
            .iter()
            .filter_map(|(handle, constant)| {
                let Expression::Literal(literal) = module.global_expressions[constant.init] else {
                    return None;
                };
                Some((handle, literal))
            })
            .collect(),
    };
    let functions = module.functions.iter_mut().map(|(_, function)| function);
    let all = functions.chain(module.entry_points.iter_mut().map(|point| &mut point.function));
    let changed: Vec<_> = all.map(|function| simplify_function(function, &known)).collect();
    changed.contains(&true)
}

/// What is the same wherever it stands.
struct Known {
    results: HashMap<Handle<Function>, Literal>,
    constants: HashMap<Handle<Constant>, Literal>,
}

fn simplify_function(function: &mut Function, known: &Known) -> bool {
    let folded = fold(function, known);
    let mut body = std::mem::take(&mut function.body);
    let pruned = prune(&mut body, &function.expressions);
    function.body = body;
    // Else naga keeps what has a name, used or not.
    function.named_expressions.clear();
    folded || pruned
}

fn literal(function: &Function, handle: Handle<Expression>) -> Option<Literal> {
    match function.expressions[handle] {
        Expression::Literal(literal) => Some(literal),
        _ => None,
    }
}

/// What a function returns whatever it is given, where that is so.
fn constant_result(function: &Function) -> Option<Literal> {
    let has_effect = |statement: &&Statement| match statement {
        Statement::Emit(_) => false,
        Statement::Store { pointer, .. } => {
            !matches!(function.expressions[*pointer], Expression::LocalVariable(_))
        }
        _ => true,
    };
    match function.body.iter().find(has_effect)? {
        Statement::Return { value } => literal(function, (*value)?),
        _ => None,
    }
}

/// Replaces expressions by what they are known to be: truths of truths, variables that hold one truth
/// (naga makes them for `&&` and `||`), and constant results.
fn fold(function: &mut Function, known: &Known) -> bool {
    let mut stores = HashMap::<_, Vec<_>>::new();
    collect_stores(&function.body, &mut |pointer, value| {
        if let Expression::LocalVariable(variable) = function.expressions[pointer] {
            stores.entry(variable).or_default().push(literal(function, value));
        }
    });
    let truth = |handle| match literal(function, handle) {
        Some(Literal::Bool(truth)) => Some(truth),
        _ => None,
    };
    let folded = |expression: &Expression| match *expression {
        Expression::Unary { op: UnaryOperator::LogicalNot, expr } => Some(Literal::Bool(!truth(expr)?)),
        Expression::Binary { op: BinaryOperator::LogicalAnd, left, right } => {
            Some(Literal::Bool(truth(left)? && truth(right)?))
        }
        Expression::Binary { op: BinaryOperator::LogicalOr, left, right } => {
            Some(Literal::Bool(truth(left)? || truth(right)?))
        }
        Expression::CallResult(called) => known.results.get(&called).copied(),
        Expression::Constant(constant) => known.constants.get(&constant).copied(),
        Expression::Load { pointer } => match function.expressions[pointer] {
            // A variable with a name may have a value before it is stored to.
            Expression::LocalVariable(variable) if function.local_variables[variable].name.is_none() => {
                match stores.get(&variable)?.as_slice() {
                    [Some(truth @ Literal::Bool(_))] => Some(*truth),
                    _ => None,
                }
            }
            _ => None,
        },
        _ => None,
    };
    let found: Vec<_> = function.expressions.iter().filter_map(|(h, e)| Some((h, folded(e)?))).collect();
    for (handle, value) in &found {
        *function.expressions.get_mut(*handle) = Expression::Literal(*value);
    }
    !found.is_empty()
}

fn collect_stores(block: &Block, found: &mut impl FnMut(Handle<Expression>, Handle<Expression>)) {
    for statement in block {
        match statement {
            Statement::Store { pointer, value } => found(*pointer, *value),
            Statement::Block(block) => collect_stores(block, found),
            Statement::If { accept, reject, .. } => {
                collect_stores(accept, found);
                collect_stores(reject, found);
            }
            Statement::Loop { body, continuing, .. } => {
                collect_stores(body, found);
                collect_stores(continuing, found);
            }
            Statement::Switch { cases, .. } => {
                cases.iter().for_each(|case| collect_stores(&case.body, found));
            }
            _ => {}
        }
    }
}

/// Leaves of a branch with a known condition the side that runs, and nothing of what follows an end.
fn prune(block: &mut Block, expressions: &wgpu::naga::Arena<Expression>) -> bool {
    let (before, mut changed) = (std::mem::take(block), false);
    for (mut statement, span) in before.span_into_iter() {
        if ends(block) {
            return true;
        }
        match &mut statement {
            Statement::If { condition, accept, reject } => {
                if let Expression::Literal(Literal::Bool(truth)) = expressions[*condition] {
                    block.append(if truth { accept } else { reject });
                    changed = true;
                    continue;
                }
                changed |= prune(accept, expressions) | prune(reject, expressions);
            }
            Statement::Block(inner) => changed |= prune(inner, expressions),
            Statement::Loop { body, continuing, .. } => {
                changed |= prune(body, expressions) | prune(continuing, expressions);
            }
            // A call whose result is known.
            Statement::Call { result: Some(result), .. }
                if matches!(expressions[*result], Expression::Literal(_)) =>
            {
                changed = true;
                continue;
            }
            _ => {}
        }
        block.push(statement, span);
    }
    changed
}

fn ends(block: &Block) -> bool {
    match block.last() {
        Some(Statement::Return { .. } | Statement::Break | Statement::Continue | Statement::Kill) => true,
        Some(Statement::Block(inner)) => ends(inner),
        Some(Statement::If { accept, reject, .. }) => ends(accept) && ends(reject),
        _ => false,
    }
}
