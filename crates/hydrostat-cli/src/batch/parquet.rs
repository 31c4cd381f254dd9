//! The one file that knows Parquet.

use super::table::{Table, Values};
use arrow_array::{
    ArrayRef, BooleanArray, FixedSizeListArray, Float64Array, RecordBatch, StringArray, UInt64Array,
};
use arrow_buffer::NullBuffer;
use arrow_schema::{DataType, Field, Schema, SchemaRef};
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::file::properties::WriterProperties;
use parquet::schema::types::ColumnPath;
use std::fs::File;
use std::io;
use std::sync::Arc;

pub(super) struct Parquet {
    schema: SchemaRef,
    writer: ArrowWriter<File>,
}

impl Parquet {
    pub(super) fn create(file: File, columns: &Table) -> io::Result<Parquet> {
        let mut fields =
            vec![Field::new("row", DataType::UInt64, false), Field::new("status", DataType::Utf8, false)];
        fields.extend(columns.columns.iter().map(|(name, values)| Field::new(name, kind(values), true)));
        let schema = Arc::new(Schema::new(fields));
        // a dictionary of statuses is short, one of positions is as long as the column
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_dictionary_enabled(false)
            .set_column_dictionary_enabled(ColumnPath::from("status"), true)
            .build();
        let writer = ArrowWriter::try_new(file, Arc::clone(&schema), Some(properties))?;
        Ok(Parquet { schema, writer })
    }

    pub(super) fn write(&mut self, table: &Table) -> io::Result<()> {
        let solved = NullBuffer::from(table.solved.clone());
        let mut arrays: Vec<ArrayRef> = vec![
            Arc::new(UInt64Array::from(table.row.clone())),
            Arc::new(StringArray::from_iter_values(&table.status)),
        ];
        arrays.extend(table.columns.iter().map(|(_, values)| array(values, &table.solved, &solved)));
        let batch = RecordBatch::try_new(Arc::clone(&self.schema), arrays).map_err(io::Error::other)?;
        Ok(self.writer.write(&batch)?)
    }

    pub(super) fn close(self) -> io::Result<()> {
        self.writer.close()?;
        Ok(())
    }
}

fn kind(values: &Values) -> DataType {
    match values {
        Values::Numbers(_) => DataType::Float64,
        Values::Flags(_) => DataType::Boolean,
        Values::Lists(stations, _) => DataType::FixedSizeList(item(), *stations as i32),
    }
}

fn item() -> Arc<Field> {
    Arc::new(Field::new("item", DataType::Float64, false))
}

fn array(values: &Values, rows: &[bool], solved: &NullBuffer) -> ArrayRef {
    let valid = Some(solved.clone());
    match values {
        Values::Numbers(numbers) => Arc::new(Float64Array::new(numbers.clone().into(), valid)),
        Values::Flags(flags) => {
            let known = flags.iter().zip(rows).map(|(flag, solved)| flag.filter(|_| *solved));
            Arc::new(known.collect::<BooleanArray>())
        }
        Values::Lists(stations, numbers) => {
            let numbers = Arc::new(Float64Array::from(numbers.clone()));
            Arc::new(FixedSizeListArray::new(item(), *stations as i32, numbers, valid))
        }
    }
}
