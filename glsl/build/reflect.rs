//! Reads a shader's interface back from its SPIR-V: bindings, local size, push constants, struct layouts.

use std::collections::{BTreeMap, HashMap};

use rspirv::{
    dr::{Instruction, Module, Operand},
    spirv::{Decoration, ExecutionMode, Op, StorageClass},
};

#[derive(Debug)]
pub(crate) struct Interface {
    pub(crate) local_size: [u32; 3],
    pub(crate) push_constant_bytes: u32,
    pub(crate) bindings: Vec<Binding>,
    /// Laid-out structs by name; `Params` of pass `x_y` is called `XYParams`.
    pub(crate) structs: BTreeMap<String, Struct>,
}

#[derive(Debug)]
pub(crate) struct Binding {
    pub(crate) name: String,
    pub(crate) binding: u32,
    pub(crate) count: u32,
    pub(crate) element_bytes: u32,
    pub(crate) writable: bool,
}

#[derive(Debug, PartialEq)]
pub(crate) struct Struct {
    pub(crate) size: u32,
    pub(crate) members: Vec<(String, u32)>,
}

pub(crate) fn interface(pass: &str, words: &[u32]) -> Result<Interface, String> {
    let module = rspirv::dr::load_words(words).map_err(|e| format!("{pass}: {e}"))?;
    let reflection = Reflection::new(&module);
    let mut structs = BTreeMap::new();
    for (id, members) in &reflection.offsets {
        let name = struct_name(pass, &reflection.name(*id));
        // Blocks that merely hold a stream's runtime array are bindings, not structs.
        if name.ends_with("_block") || members.is_empty() {
            continue;
        }
        let layout = reflection.layout(*id, members)?;
        if structs.get(&name).is_some_and(|other| *other != layout) {
            return Err(format!("{pass}: struct {name} is laid out in two ways; use scalar layout everywhere"));
        }
        structs.insert(name, layout);
    }
    Ok(Interface {
        local_size: reflection.local_size(pass)?,
        push_constant_bytes: reflection.push_constant_bytes()?,
        bindings: reflection.bindings(pass)?,
        structs,
    })
}

fn struct_name(pass: &str, name: &str) -> String {
    if name != "Params" {
        return name.to_owned();
    }
    let camel: String = pass.split('_').map(|word| word[..1].to_uppercase() + &word[1..]).collect();
    format!("{camel}Params")
}

struct Reflection<'m> {
    module: &'m Module,
    types: HashMap<u32, &'m Instruction>,
    names: HashMap<u32, String>,
    member_names: HashMap<(u32, u32), String>,
    decorations: HashMap<(u32, Decoration), u32>,
    read_only: Vec<u32>,
    read_only_members: Vec<(u32, u32)>,
    offsets: BTreeMap<u32, BTreeMap<u32, u32>>,
}

impl<'m> Reflection<'m> {
    fn new(module: &'m Module) -> Self {
        let types = module.types_global_values.iter().filter_map(|i| Some((i.result_id?, i))).collect();
        let mut this = Self {
            module,
            types,
            names: HashMap::new(),
            member_names: HashMap::new(),
            decorations: HashMap::new(),
            read_only: Vec::new(),
            read_only_members: Vec::new(),
            offsets: BTreeMap::new(),
        };
        module.debug_names.iter().for_each(|i| this.read_name(i));
        module.annotations.iter().for_each(|i| this.read_annotation(i));
        this
    }

    fn read_name(&mut self, i: &Instruction) {
        match (i.class.opcode, i.operands.as_slice()) {
            (Op::Name, [Operand::IdRef(id), Operand::LiteralString(name)]) => {
                self.names.insert(*id, name.clone());
            }
            (Op::MemberName, [Operand::IdRef(id), Operand::LiteralBit32(member), Operand::LiteralString(name)]) => {
                self.member_names.insert((*id, *member), name.clone());
            }
            _ => {}
        }
    }

    fn read_annotation(&mut self, i: &Instruction) {
        use Operand::{Decoration as D, IdRef, LiteralBit32 as N};
        match (i.class.opcode, i.operands.as_slice()) {
            (Op::Decorate, [IdRef(id), D(Decoration::NonWritable)]) => self.read_only.push(*id),
            (Op::Decorate, [IdRef(id), D(decoration), N(value)]) => {
                self.decorations.insert((*id, *decoration), *value);
            }
            (Op::MemberDecorate, [IdRef(id), N(member), D(Decoration::Offset), N(offset)]) => {
                self.offsets.entry(*id).or_default().insert(*member, *offset);
            }
            (Op::MemberDecorate, [IdRef(id), N(member), D(Decoration::NonWritable)]) => {
                self.read_only_members.push((*id, *member));
            }
            _ => {}
        }
    }

    fn name(&self, id: u32) -> String {
        self.names.get(&id).cloned().unwrap_or_default()
    }

    fn type_of(&self, id: u32) -> Result<&'m Instruction, String> {
        self.types.get(&id).copied().ok_or(format!("no type %{id}"))
    }

    fn local_size(&self, pass: &str) -> Result<[u32; 3], String> {
        use Operand::{ExecutionMode as Mode, LiteralBit32 as N};
        for mode in &self.module.execution_modes {
            if let [_, Mode(ExecutionMode::LocalSize), N(x), N(y), N(z)] = mode.operands.as_slice() {
                return Ok([*x, *y, *z]);
            }
        }
        Err(format!("{pass}: no literal local size"))
    }

    fn variables(&self, class: StorageClass) -> impl Iterator<Item = (u32, u32)> {
        self.module.types_global_values.iter().filter_map(move |i| {
            let storage = i.operands.first().is_some_and(|o| *o == Operand::StorageClass(class));
            (i.class.opcode == Op::Variable && storage).then_some(())?;
            let pointer = self.types.get(&i.result_type?)?;
            Some((i.result_id?, pointer.operands.get(1)?.unwrap_id_ref()))
        })
    }

    fn push_constant_bytes(&self) -> Result<u32, String> {
        self.variables(StorageClass::PushConstant).next().map_or(Ok(0), |(_, ty)| self.size(ty))
    }

    fn bindings(&self, pass: &str) -> Result<Vec<Binding>, String> {
        let variables = self.variables(StorageClass::StorageBuffer);
        let mut bindings = variables.map(|(v, ty)| self.binding(pass, v, ty)).collect::<Result<Vec<_>, _>>()?;
        bindings.sort_by_key(|b| b.binding);
        if let Some(pair) = bindings.windows(2).find(|pair| pair[0].binding == pair[1].binding) {
            return Err(format!("{pass}: {} and {} share binding {}", pair[0].name, pair[1].name, pair[0].binding));
        }
        Ok(bindings)
    }

    fn binding(&self, pass: &str, variable: u32, ty: u32) -> Result<Binding, String> {
        let of = self.type_of(ty)?;
        let (block, count) = match of.class.opcode {
            Op::TypeArray => (of.operands[0].unwrap_id_ref(), self.constant(of.operands[1].unwrap_id_ref())?),
            _ => (ty, 1),
        };
        let members = &self.type_of(block)?.operands;
        let last = members.last().ok_or(format!("{pass}: an empty block"))?.unwrap_id_ref();
        let own = self.name(variable);
        let name = if own.is_empty() { self.name(block).trim_end_matches("_block").to_owned() } else { own };
        let set = self.decorations.get(&(variable, Decoration::DescriptorSet)).copied().unwrap_or(0);
        if set != 0 {
            return Err(format!("{pass}: {name} is in descriptor set {set}; every binding is in set 0"));
        }
        let binding = self.decorations.get(&(variable, Decoration::Binding)).copied();
        let read_only = self.read_only.contains(&variable)
            || (0..members.len() as u32).all(|member| self.read_only_members.contains(&(block, member)));
        Ok(Binding {
            binding: binding.ok_or(format!("{pass}: {name} has no binding number"))?,
            name,
            count,
            element_bytes: self.decorations.get(&(last, Decoration::ArrayStride)).copied().unwrap_or(0),
            writable: !read_only,
        })
    }

    fn constant(&self, id: u32) -> Result<u32, String> {
        match self.type_of(id)?.operands.as_slice() {
            [Operand::LiteralBit32(value)] => Ok(*value),
            _ => Err(format!("constant %{id} is not a 32-bit literal")),
        }
    }

    fn layout(&self, id: u32, offsets: &BTreeMap<u32, u32>) -> Result<Struct, String> {
        let member_name = |member: u32| self.member_names.get(&(id, member)).cloned().unwrap_or_default();
        let members = offsets.iter().map(|(member, offset)| (member_name(*member), *offset)).collect();
        Ok(Struct { size: self.size(id)?, members })
    }

    /// Size in scalar layout, with the tail padding `repr(C)` has too.
    fn size(&self, id: u32) -> Result<u32, String> {
        let ty = self.type_of(id)?;
        let operand = |i: usize| ty.operands[i].unwrap_id_ref();
        Ok(match ty.class.opcode {
            Op::TypeInt | Op::TypeFloat => ty.operands[0].unwrap_literal_bit32() / 8,
            Op::TypeVector | Op::TypeMatrix => self.size(operand(0))? * ty.operands[1].unwrap_literal_bit32(),
            Op::TypeArray => {
                let stride = self.decorations.get(&(id, Decoration::ArrayStride)).copied();
                stride.map_or_else(|| self.size(operand(0)), Ok)? * self.constant(operand(1))?
            }
            Op::TypeRuntimeArray => 0,
            Op::TypeStruct => {
                let offsets = self.offsets.get(&id).ok_or(format!("struct %{id} has no layout"))?;
                let ends = offsets.iter().map(|(m, offset)| Ok(offset + self.size(operand(*m as usize))?));
                let end = ends.collect::<Result<Vec<u32>, String>>()?.into_iter().max().unwrap_or(0);
                end.next_multiple_of(self.align(id)?)
            }
            other => return Err(format!("a {other:?} in a shared struct")),
        })
    }

    fn align(&self, id: u32) -> Result<u32, String> {
        let ty = self.type_of(id)?;
        match ty.class.opcode {
            Op::TypeVector | Op::TypeMatrix | Op::TypeArray | Op::TypeRuntimeArray => {
                self.align(ty.operands[0].unwrap_id_ref())
            }
            Op::TypeStruct => ty.operands.iter().try_fold(1, |a, m| Ok(a.max(self.align(m.unwrap_id_ref())?))),
            _ => self.size(id),
        }
    }
}
