//! Units and meanings beside the columns of a Parquet table.
//!
//! Parquet has no place for them. Readers of Arrow take them from the Arrow schema that a file may hold under the key
//! `ARROW:schema`: a message of Arrow's interchange format (a FlatBuffer after its marker and its length), as base64.
//! Tables and slots are those of Arrow's `Schema.fbs` and `Message.fbs`; a field of a FlatBuffer has its number there.

use base64::{Engine, prelude::BASE64_STANDARD};
use flatbuffers::{FlatBufferBuilder, ForwardsUOffset, TableFinishedWIPOffset, VOffsetT, Vector, WIPOffset};
use maille::record::Kind;

/// The key of the file's metadata that readers look under.
pub(super) const KEY: &str = "ARROW:schema";

type Offset = WIPOffset<TableFinishedWIPOffset>;
type Tables<'a> = WIPOffset<Vector<'a, ForwardsUOffset<TableFinishedWIPOffset>>>;

/// A column: its name, its kind, and what is said of it.
pub(super) struct ArrowField<'a> {
    pub name: &'a str,
    pub kind: Kind,
    pub metadata: Vec<(&'static str, String)>,
}

/// The Arrow schema of columns that may all be null, with metadata of the whole, as the file keeps it.
pub(super) fn arrow_schema(fields: &[ArrowField<'_>], metadata: &[(&str, String)]) -> String {
    let mut message = Message(FlatBufferBuilder::new());
    let fields: Vec<_> = fields.iter().map(|field| message.field(field)).collect();
    let fields = message.0.create_vector(&fields);
    let metadata = message.pairs(metadata);
    let schema = message.table(|message| {
        message.0.push_slot_always(slot(1), fields);
        message.0.push_slot_always(slot(2), metadata);
    });
    let root = message.table(|message| {
        message.0.push_slot_always(slot(0), 4_i16); // the format's version 5, counted from 0
        message.0.push_slot_always(slot(1), 1_u8); // a schema follows
        message.0.push_slot_always(slot(2), schema);
    });
    message.0.finish_minimal(root);
    let bytes = message.0.finished_data();
    let length = u32::try_from(bytes.len()).expect("a schema is smaller than 4 GiB");
    BASE64_STANDARD.encode([&u32::MAX.to_le_bytes(), &length.to_le_bytes(), bytes].concat())
}

/// Where the field of a table stands in its list of offsets, which begins with two sizes.
fn slot(number: VOffsetT) -> VOffsetT {
    4 + 2 * number
}

struct Message<'a>(FlatBufferBuilder<'a>);

impl<'a> Message<'a> {
    fn table(&mut self, fill: impl FnOnce(&mut Self)) -> Offset {
        let start = self.0.start_table();
        fill(self);
        self.0.end_table(start)
    }

    fn field(&mut self, field: &ArrowField<'_>) -> Offset {
        let name = self.0.create_string(field.name);
        let (number, kind) = self.kind(field.kind);
        let children = self.0.create_vector::<ForwardsUOffset<TableFinishedWIPOffset>>(&[]);
        let metadata = self.pairs(&field.metadata);
        self.table(|message| {
            message.0.push_slot_always(slot(0), name);
            message.0.push_slot_always(slot(1), true); // nullable
            message.0.push_slot_always(slot(2), number);
            message.0.push_slot_always(slot(3), kind);
            message.0.push_slot_always(slot(5), children);
            message.0.push_slot_always(slot(6), metadata);
        })
    }

    /// The number of a type in Arrow's union of types, and its parameters.
    fn kind(&mut self, kind: Kind) -> (u8, Offset) {
        let number = match kind {
            Kind::Count => 2,  // Int
            Kind::Number => 3, // FloatingPoint
            Kind::Text => 5,   // Utf8
            Kind::Flag => 6,   // Bool
        };
        let parameters = self.table(|message| match kind {
            Kind::Count => {
                message.0.push_slot_always(slot(0), 64_i32);
                message.0.push_slot_always(slot(1), true); // signed
            }
            Kind::Number => message.0.push_slot_always(slot(0), 2_i16), // double precision
            Kind::Text | Kind::Flag => {}
        });
        (number, parameters)
    }

    fn pairs(&mut self, pairs: &[(&str, String)]) -> Tables<'a> {
        let pairs: Vec<_> = pairs
            .iter()
            .map(|(key, value)| {
                let (key, value) = (self.0.create_string(key), self.0.create_string(value));
                self.table(|message| {
                    message.0.push_slot_always(slot(0), key);
                    message.0.push_slot_always(slot(1), value);
                })
            })
            .collect();
        self.0.create_vector(&pairs)
    }
}
